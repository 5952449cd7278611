# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The motions of a rig's payload and what they do along its struts, in one unit: for laws, figures and comparisons."""

from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array
from satvib_common.struts.motions import mode_matrix, strut_matrix

from satvib_plant_sim.rig.geometry import payload_matrix
from satvib_plant_sim.rig.rig import Rig


class PayloadModes(NamedTuple):
    """The motions of a payload, m of them, on n struts.

    Attributes:
        names: w, alpha, beta for struts on a circle (w alone for one); of x, y, z, rx, ry, rz for listed ones.
        strut: (n, m) T: what each motion does along each strut. A turn is the motion that it makes at `radius`.
        mode: (m, n) T^-1, or the pseudo-inverse where there are more struts than motions.
        radius: m, at which turns are counted: of the circle, or the mean distance (RMS) of the struts' heads from the
            centre of gravity.
        tilts: which of the motions turn the line of sight, which is along z: rotations about x and about y.
    """

    names: tuple[str, ...]
    strut: Array
    mode: Array
    radius: float
    tilts: tuple[int, ...]


def payload_modes(rig: Rig) -> PayloadModes:
    """Give the motions of a rig's payload."""
    struts, payload = rig.struts, rig.payload
    if not struts.each:
        names = ('w', 'alpha', 'beta')[: struts.count]
        return PayloadModes(
            names=names,
            strut=strut_matrix(struts.angles),
            mode=mode_matrix(struts.angles),
            radius=struts.radius,
            tilts=tuple(range(1, struts.count)),
        )
    ends = np.array([strut.head or strut.foot for strut in struts.each])
    arms = ends - np.array(payload.center_of_gravity)
    radius = float(np.sqrt(np.mean(np.sum(arms * arms, axis=1))))
    turns = np.array([motion.startswith('r') for motion in payload.motions])
    strut = payload_matrix(payload, struts) / np.where(turns, radius, 1.0)
    return PayloadModes(
        names=payload.motions,
        strut=strut,
        mode=np.array(np.linalg.pinv(strut), dtype=np.float64),
        radius=radius,
        tilts=tuple(i for i, motion in enumerate(payload.motions) if motion in {'rx', 'ry'}),
    )
