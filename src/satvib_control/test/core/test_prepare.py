# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A model is taken between two samples, so that no voltage waits for a design; no bit changes by it."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from satvib_common.phases import Phase, PhasePlan
from satvib_control.core.controller import ControllerCore
from satvib_control.laws.base import BasicLaw

RATE = 200.0
# the model waits for STANDBY; another one comes at sample 700
PLAN = PhasePlan(
    (Phase.CALIBRATE, Phase.IDENTIFY, Phase.STANDBY, Phase.ADAPT, Phase.CONTROL),
    (0, 100, 500, 600, 900),
    1500,
)
PERIOD = 150  # samples between hand-overs
LAWS = ['velocity_feedback', 'model_reference', 'narrowband', 'feedforward']


def run(core, models, early):
    """Voltages and adaptation of random samples; `early`: a model is taken after the sample before."""
    rng = np.random.default_rng(3)
    found = []
    for k in range(PLAN.end):
        upper = 0.01 * rng.standard_normal() + np.sin(2 * np.pi * 11.0 * k / RATE)
        lower = 0.02 * rng.standard_normal() + np.sin(2 * np.pi * 11.0 * k / RATE + 0.3)
        if PLAN.is_hand_over(k, PERIOD) and not early:
            core.set_model(models[k >= 700])
        out = core.step(k, PLAN, np.asarray(upper), np.asarray(lower))
        found.append((float(out.voltage), float(out.state.weight_norm), float(out.state.error)))
        if early and k + 1 < PLAN.end:
            if PLAN.is_hand_over(k + 1, PERIOD):
                core.set_model(models[k + 1 >= 700])
            core.prepare(PLAN.at(k + 1))
            assert PLAN.at(k + 1) is Phase.IDENTIFY or not core.designs_wait
    return np.array(found)


@pytest.mark.parametrize('law', LAWS)
def test_no_bit_changes(law, settings, make_isolator):
    """Truth: the same law that takes its models within the sample."""
    models = make_isolator(RATE), make_isolator(RATE, wn=120.0)
    parameters = settings(sample_rate=RATE, law=law)
    late, early = (run(ControllerCore(parameters), models, e) for e in (False, True))
    assert np.any(late[900:, 0] != 0.0)
    assert_array_equal(early, late)


class Spy(BasicLaw):
    """Says where it was when a model came."""

    needs_model = True

    def __init__(self, parameters, dt, shape=()):
        super().__init__(parameters, dt, shape)
        self.came_at = []
        self.samples = 0

    def set_model(self, model, trusted, covariance=None):  # noqa: ARG002
        self.came_at.append(self.samples)

    def step(self, x, phase):  # noqa: ARG002
        self.samples = x.sequence + 1
        return np.zeros(self.shape)


def test_a_model_is_there_before_its_sample(settings, make_isolator):
    """Truth: by hand. The other one comes within ADAPT."""
    core = ControllerCore(settings(sample_rate=RATE, law='off'))
    core.law = Spy(core.parameters, core.dt)
    run(core, (make_isolator(RATE), make_isolator(RATE, wn=120.0)), early=True)
    assert core.law.came_at == [500, 700]
    assert not core.designs_wait
