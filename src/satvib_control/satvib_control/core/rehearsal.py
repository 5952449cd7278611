# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Run a core like the one that is to control through every phase, so that no sample of a run waits for code to load.

Kernels and modules are loaded where they are used first. In real time that would be in the middle of a run, at the
first sample of a phase, and cost some tenths of a second.
"""

import numpy as np
from satvib_common.phases import Phase, PhasePlan
from satvib_ident.models.iir_model import IirModel

from satvib_control.core.controller import ControllerCore

_EACH = 8  # samples of a phase


def rehearse(core: ControllerCore) -> None:
    """Run through all phases with a small noise and a stable model; the core is of no use afterwards."""
    phases = (Phase.STANDBY, Phase.CALIBRATE, Phase.IDENTIFY, Phase.ADAPT, Phase.CONTROL)
    plan = PhasePlan(phases, tuple(_EACH * i for i in range(len(phases))))
    model = IirModel(np.array([-0.46, 0.158]), np.array([0.061, -0.103, 0.033]), 1, core.dt)
    covariance = 1e-6 * np.eye(5)
    noise = 1e-3 * np.random.default_rng(1).standard_normal((2, _EACH * len(phases), *core.shape))
    for k in range(_EACH * len(phases)):
        if plan.is_hand_over(k, _EACH // 2):
            core.set_model(model, covariance=covariance)
        core.step(k, plan, noise[0, k], noise[1, k])
