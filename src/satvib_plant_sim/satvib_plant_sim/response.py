# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The linear rig in the frequency domain and at rest, for analysis and for the amplitude of disturbances."""

import math

import numpy as np
from numpy.typing import NDArray

from satvib_plant_sim.mechanics import mechanics
from satvib_plant_sim.rig import Rig

Array = NDArray[np.float64]


def source_transfer(rig: Rig, frequency: float) -> float:
    """Give |T(jw)| from the source's acceleration to the lower plate's, at 0 V.

    Args:
        rig: the rig.
        frequency: Hz.
    """
    m = mechanics(rig)
    n = rig.struts.count
    s = 2j * math.pi * frequency
    x = np.linalg.solve(s * np.eye(len(m.A)) - m.A, m.B[:, n])
    return float(abs(m.C[n] @ x + m.D[n, n]))
