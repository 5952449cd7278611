# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The supervisor on three struts that shake each other. Truth: which strut was made the cause."""

import numpy as np
import pytest
from satvib_common.phases import Phase, PhasePlan
from satvib_control.supervision.parameters import SupervisorParameters
from satvib_control.supervision.supervisor import Ask, SupervisorCore, check_period, is_checked

RATE = 100.0
PLAN = PhasePlan((Phase.CALIBRATE, Phase.STANDBY, Phase.CONTROL), (0, 50, 300), 10**6)


class Isolator:
    """Struts of a tone of 10 Hz; what is added by those of `causes` is heard by all while their voltage acts."""

    def __init__(self, causes, gain=4.0, shape=(3,)):
        self.core = SupervisorCore(SupervisorParameters(sample_rate=RATE), shape)
        self.causes, self.gain = np.array(causes), gain
        self.share = np.ones(shape)  # of the voltage
        self.stopped = np.zeros(shape, dtype=bool)
        self.asked = []

    def run(self, seconds, first=0, growth=1.0, law=True):
        """Run; give the RMS over the last second (struts)."""
        ys = []
        for k in range(first, first + int(seconds * RATE)):
            tone = np.sin(2 * np.pi * 10.0 * k / RATE) * (0.0 if k < 50 else growth)
            acts = (k >= 300) & law
            u = acts * self.share * np.sin(2 * np.pi * 10.0 * k / RATE + 1.0)
            shaken = self.gain * (np.abs(self.share) * self.causes).sum() * (k >= 600)
            y = tone * (1.0 + acts * shaken)
            ys.append(np.full(3, y))
            asks = self.core.step(k, PLAN, np.full(self.share.shape, y), u)
            for i in np.flatnonzero(asks):
                self.asked.append((k, int(i), Ask(int(asks[i]))))
            self.share = np.where((asks == Ask.HOLD) | (asks == Ask.STOP), 0.0, self.share)
            self.stopped = self.stopped | (asks == Ask.STOP)
            self.share = np.where((asks == Ask.RELEASE) & ~self.stopped, 1.0, self.share)
        return np.sqrt(np.mean(np.array(ys)[-int(RATE) :] ** 2, axis=0))


@pytest.mark.parametrize('cause', range(3))
def test_it_stops_the_cause_and_no_other(cause):
    """Truth: the strut that was made the cause. At most 5 s in a row loud; the others act in the end."""
    isolator = Isolator([1.0 if i == cause else 0.0 for i in range(3)])
    isolator.run(40)
    assert isolator.stopped.tolist() == [i == cause for i in range(3)]
    assert isolator.share.tolist() == [0.0 if i == cause else 1.0 for i in range(3)]
    first = next(k for k, i, ask in isolator.asked if i == cause and ask == Ask.HOLD)
    assert first - 600 < 5.0 * RATE


def test_a_disturbance_that_has_grown_stops_nobody():
    """Truth: no law is the cause. Everything is released, nothing is stopped, and what is heard then is usual."""
    isolator = Isolator([0.0, 0.0, 0.0])
    isolator.run(6)
    isolator.run(30, first=600, growth=3.0)
    assert not isolator.stopped.any()
    assert isolator.share.tolist() == [1.0, 1.0, 1.0]
    assert [ask for _, _, ask in isolator.asked] == [Ask.HOLD] * 3 + [Ask.RELEASE] * 3


def test_it_asks_at_checks_only():
    """Truth: what is asked at sample k holds from k + 1 on, which is a multiple of the period."""
    isolator = Isolator([1.0, 0.0, 0.0])
    isolator.run(20)
    assert isolator.asked
    assert check_period(RATE) == 10
    for k, _, _ in isolator.asked:
        assert is_checked(k + 1, RATE)


def test_bits_do_not_depend_on_the_batch():
    """Truth: the isolator alone."""
    rng = np.random.default_rng(4)
    upper, voltage = rng.standard_normal((2, 1500, 2, 3))
    upper[600:] *= 4.0
    parameters = SupervisorParameters(sample_rate=RATE)
    batch = SupervisorCore(parameters, (2, 3))
    alone = [SupervisorCore(parameters, (3,)) for _ in range(2)]
    asked = 0
    for k in range(len(upper)):
        voltage[k] *= k >= 300
        together = batch.step(k, PLAN, upper[k], voltage[k])
        for i, core in enumerate(alone):
            np.testing.assert_array_equal(
                core.step(k, PLAN, upper[k, i], voltage[k, i]), together[i]
            )
        asked += np.count_nonzero(together)
    assert asked > 0
