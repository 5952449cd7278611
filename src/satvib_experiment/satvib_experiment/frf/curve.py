# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One measured frequency response with its names, and what is known to compare it with."""

from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Complex
from satvib_common.levels import decibel
from satvib_ident.frequency.response import FrequencyResponse

TRANSMISSIBILITY = 'transmissibility'  # m/s^2 per m/s^2
PATH = 'path'  # m/s^2 per V
OPEN = 'open'
BASE = 'base'  # which heaves; 'base_x' and so on where it moves otherwise
HEAVE = 'heave'
SURE = 0.99  # coherence from which a deviation counts


@dataclass(frozen=True, eq=False)
class Curve:
    """One output per one input.

    Attributes:
        quantity: TRANSMISSIBILITY or PATH.
        loop: OPEN, or the name of the law that acted.
        output, input: 'strut_1', 'heave', 'tilt_x', 'base' and so on.
        measured: (f,) what was measured.
        exact: (f,) what the rig has, None where it is not known.
        model: (f,) what the identified model has, None without one.
        is_motion: the output is a motion of the payload, not that of a strut.
    """

    quantity: str
    loop: str
    output: str
    input: str
    measured: FrequencyResponse
    exact: Complex | None = None
    model: Complex | None = None
    is_motion: bool = False

    @property
    def is_cross(self) -> bool:
        """Whether the output is a motion that the base has not, such as a tilt of a payload whose base heaves."""
        own = {BASE, f'{BASE}_{HEAVE}'} if self.output == HEAVE else {f'{BASE}_{self.output}'}
        return self.is_motion and self.input not in own

    def deviation(self) -> tuple[float, float] | None:
        """Give the largest deviation from the exact response in dB and degrees, where the coherence is above 0.99.

        None where the exact response is not known, or no coherence is above that.
        """
        sure = self.measured.coherence > SURE
        if self.exact is None or not sure.any():
            return None
        ratio = (self.measured.value / self.exact)[sure]
        return (
            float(np.max(np.abs(decibel(np.abs(ratio))))),
            float(np.max(np.abs(np.degrees(np.angle(ratio))))),
        )
