# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Dead zone: a sample whose error is no larger than the noise is not used.

    update only if |e| > zone

Bounded disturbances up to the zone can then never make the estimate drift; it also stops within the zone of the
truth and stays there (P. A. Ioannou and J. Sun, Robust Adaptive Control, 1996, section 8.5). Choose about three
deviations of the noise.
"""

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError

from satvib_ident.forgetting.none import ONE, NoForgetting
from satvib_ident.forgetting.protocol import Factors


class DeadZone(NoForgetting):
    """Leave out errors of at most `zone` (units of the output)."""

    def __init__(self, zone: float) -> None:
        if not zone >= 0.0:
            raise SatvibError(f'dead_zone: {zone} is negative')
        self.zone = zone

    def apply(
        self,
        estimator: Factors,
        w: Array,  # noqa: ARG002
        error: Array,
        active: Mask,
    ) -> tuple[Array, Array, Mask]:
        """Leave small errors out."""
        return ONE, error, active & (np.abs(error) > self.zone * estimator.error_scale)
