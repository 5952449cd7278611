# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""No control: 0 V. This is the open loop that attenuations refer to."""

import numpy as np
from satvib_common.arrays import Array
from satvib_common.phases import Phase

from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.parameters import LawParameters


class Off(BasicLaw[LawParameters]):
    """u = 0."""

    def step(self, x: LawInput, phase: Phase) -> Array:  # noqa: ARG002 - the interface
        """Give 0 V (shape)."""
        return np.zeros(self.shape)
