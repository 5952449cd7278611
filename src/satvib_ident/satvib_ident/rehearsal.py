# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Run an identifier like the one that is to estimate, so that no sample of a run waits for code to be loaded."""

import numpy as np
from satvib_common.phases import Phase

from satvib_ident.identifier import IdentifierCore

_REST, _EXCITED = 24, 40  # samples


def rehearse(core: IdentifierCore) -> None:
    """Calibrate, and estimate from a noise; the core is of no use afterwards."""
    count = _REST + _EXCITED
    upper, voltage = np.random.default_rng(1).standard_normal((2, count, *core.shape))
    estimated = next((Phase[name] for name in core.parameters.estimate_in), Phase.IDENTIFY)
    for k in range(count):
        rest = k < _REST
        phase = Phase.CALIBRATE if rest else estimated
        core.step(
            k, phase, upper[k] * (1e-3 if rest else 1.0), np.asarray(0.0 if rest else voltage[k])
        )
