# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The bridge alone, in real time on a clock that the test turns: what it makes of samples, silence and lateness.

Truth: the rules of its docstring and of docs/hardware.md.
"""

import math

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_daq_bridge.bridge.bridge import Bridge
from satvib_daq_bridge.bridge.timing import Timing
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.guardian import link
from satvib_daq_bridge.parameters import BridgeParameters
from satvib_daq_bridge.simulated.channels_from_rig import channels_of
from satvib_daq_bridge.states import State
from satvib_plant_sim.rig.rig import load_rig

CHANNELS = parse_channels(channels_of(load_rig('paper_3dof')), 'test')
PERIOD = 0.01


class Stand:
    def __init__(self, **parameters):
        given = BridgeParameters(channels='x', sample_rate=100.0, **parameters)
        self.sent = []
        self.bridge = Bridge(CHANNELS, given, self.sent.append)
        self.now = 50.0
        self.k = -1
        self.rng = np.random.default_rng([1, 0])
        self.bridge.configured(virtual=False, now=self.now)

    @property
    def state(self):
        return self.bridge.states.state

    @property
    def reason(self):
        return self.bridge.states.reason

    def sample(self, latency=0.001, late=0.0, volts=None, skip=0):
        self.now += PERIOD * (1 + skip)
        self.k += 1 + skip
        read = 2.5 + 0.005 * self.rng.standard_normal(6) if volts is None else np.array(volts)
        taken = link.Taken(self.k, self.now, late, latency, read, np.zeros(3), 0)
        return self.bridge.take(link.pack_sample(taken), self.now + late)

    def answer(self, voltage=1.0, struts=range(3)):
        for strut in struts:
            self.bridge.command(strut, self.bridge.published, voltage)

    def activate(self):
        for _ in range(100):
            self.sample()
        self.bridge.schedule(0)
        self.bridge.arm()
        self.sample()
        self.answer()
        assert self.state is State.ACTIVE

    def modes(self):
        return [State(m[1]) for m in self.sent if m[0] == link.ToGuardian.MODE]


def test_every_change_of_state_goes_to_the_guardian_at_once():
    stand = Stand()
    stand.activate()
    stand.bridge.states.estop('button')
    assert stand.modes() == [State.IDLE, State.ARMED, State.ACTIVE, State.ESTOP]


def test_the_run_begins_with_sample_0_and_gaps_stay_gaps():
    stand = Stand()
    stand.activate()
    assert stand.bridge.published == 0
    assert stand.sample().sequence == 1
    assert stand.sample(skip=2).sequence == 4
    assert stand.bridge.lost == 2


def test_one_strut_that_never_answers_keeps_it_armed():
    stand = Stand()
    for _ in range(100):
        stand.sample()
    stand.bridge.schedule(0)
    stand.bridge.arm()
    for _ in range(10):
        stand.sample()
        stand.answer(struts=[0, 2])
    assert stand.state is State.ARMED


def test_an_answer_that_is_too_old_does_not_activate():
    """Truth: 30 ms are three periods; strut 1 answered sample 0 and then no more."""
    stand = Stand()
    for _ in range(100):
        stand.sample()
    stand.bridge.schedule(0)
    stand.bridge.arm()
    stand.sample()
    stand.answer(struts=[0])
    for _ in range(4):
        stand.sample()
    stand.answer(struts=[1, 2])
    assert stand.state is State.ARMED


def test_silence_is_a_fault_in_active_and_later_in_idle():
    """Truth: 50 ms in ACTIVE, ten times that at 0 V."""
    stand = Stand()
    stand.activate()
    stand.bridge.tick(stand.now + 0.049)
    assert stand.state is State.ACTIVE
    stand.bridge.tick(stand.now + 0.051)
    assert stand.state is State.FAULT
    assert 'no sample for 51 ms' in stand.reason
    idle = Stand()
    idle.sample()
    idle.bridge.tick(idle.now + 0.49)
    assert idle.state is State.IDLE
    idle.bridge.tick(idle.now + 0.51)
    assert idle.state is State.FAULT


def test_deadlines_missed_in_a_row_are_a_fault():
    stand = Stand(missed_limit=3)
    stand.activate()
    for latency in (0.001, 0.011, 0.012, 0.001, 0.02, math.nan):
        stand.sample(latency=latency)
        stand.answer()
    assert stand.state is State.ACTIVE
    assert stand.bridge.timing.missed == 4
    stand.sample(latency=0.01)
    assert stand.state is State.FAULT
    assert stand.reason == '3 deadlines missed in a row'


@pytest.mark.parametrize(
    ('volts', 'samples', 'said'),
    [
        ([2.5, math.nan, 2.5, 2.5, 2.5, 2.5], 1, 'strut_2.upper reads no number'),
        ([2.5, 2.6, 2.5, 2.5, 2.5, 5.0], 5, 'strut_3.lower is railed'),
        ([2.5, 2.6, 2.51, 2.52, 2.53, 2.4], 50, 'strut_1.upper is stuck'),
    ],
)
def test_a_sick_sensor_is_a_fault(volts, samples, said):
    stand = Stand()
    stand.activate()
    for _ in range(samples):
        assert stand.state is State.ACTIVE
        stand.sample(volts=volts)
        stand.answer()
    assert stand.state is State.FAULT
    assert stand.reason.startswith(said)


def test_an_implausible_bias_is_a_fault_that_reset_lets_try_again():
    stand = Stand()
    for _ in range(100):
        shaken = 2.5 + 0.2 * stand.rng.standard_normal(6)
        stand.sample(volts=shaken)
    assert stand.state is State.FAULT
    assert 'calibration: strut_1.upper: standard deviation' in stand.reason
    stand.bridge.reset()
    for _ in range(100):
        stand.sample()
    assert stand.bridge.bias.learnt


def test_a_fault_of_the_guardian_is_the_bridges():
    stand = Stand()
    stand.activate()
    stand.bridge.take(link.pack_text(link.ToBridge.FAULT, 'strut_1.coil: stale command'), stand.now)
    assert (stand.state, stand.reason) == (State.FAULT, 'strut_1.coil: stale command')


def test_a_reset_that_is_refused_releases_nothing():
    """In ACTIVE the guardian may have latched a fault of which no word has come: RESET would let voltages out again.

    Nor is what was counted towards a fault forgotten.
    """
    stand = Stand(missed_limit=3)
    stand.activate()
    for latency in (0.001, 0.011, 0.012):
        stand.sample(latency=latency)
        stand.answer()
    with pytest.raises(SatvibError, match='reset: refused in ACTIVE'):
        stand.bridge.reset()
    assert link.pack(link.ToGuardian.RESET) not in stand.sent
    stand.sample(latency=0.011)
    assert (stand.state, stand.reason) == (State.FAULT, '3 deadlines missed in a row')
    stand.bridge.reset()
    assert link.pack(link.ToGuardian.RESET) in stand.sent


def test_after_a_new_guardian_the_samples_count_on():
    stand = Stand()
    stand.activate()
    for _ in range(5):
        stand.sample()
        stand.answer()
    stand.bridge.guardian_ended('was killed by SIGKILL')
    assert stand.reason == 'the guardian was killed by SIGKILL'
    stand.bridge.restarted(stand.now)
    stand.bridge.reset()
    stand.k = -1
    assert stand.sample().sequence == 6
    stand.bridge.command(0, 5, 1.0)
    assert stand.bridge.refused == 1, 'an answer to a sample of the guardian before'


def test_the_end_of_a_record_is_the_end():
    stand = Stand()
    stand.activate()
    stand.bridge.take(link.pack_text(link.ToBridge.ENDED, 'the record is over'), stand.now)
    assert (stand.state, stand.bridge.over) == (State.IDLE, 'the record is over')


def test_a_fault_is_carried_over_to_the_next_session():
    stand = Stand()
    stand.activate()
    stand.bridge.states.fault('sick')
    stand.bridge.released('cleaned up')
    given = BridgeParameters(channels='x', sample_rate=100.0)
    after = Bridge(CHANNELS, given, lambda _: None, latched=stand.bridge.states.latched)
    after.configured(virtual=False, now=0.0)
    assert (after.states.state, after.states.reason) == (State.FAULT, 'still latched: sick')


def test_diagnostics_hold_what_a_person_wants():
    stand = Stand()
    stand.activate()
    stand.bridge.take(link.pack_text(link.ToBridge.FIGURES, {'frames': 3.0}), stand.now)
    told = stand.bridge.diagnose()
    for key in ('state', 'reason', 'samples lost', 'deadlines missed', 'sample late p99 [ms]',
                'voltage latency max [ms]', 'frames', 'strut_1.upper bias'):  # fmt: skip
        assert key in told


def test_timing_percentiles():
    """Truth: of 1 to 100 ms the median is 50.5 ms and the maximum 100 ms; NaN counts for nothing."""
    timing = Timing(0.01)
    for k in range(1, 101):
        timing.add(k * 1e-3, math.nan)
    told = timing.figures()
    assert told['sample late p50 [ms]'] == pytest.approx(50.5)
    assert told['sample late max [ms]'] == pytest.approx(100.0)
    assert 'voltage latency p50 [ms]' not in told


@pytest.mark.parametrize(
    ('rate', 'expected'), [(50.0, 0.05), (100.0, 0.03), (200.0, 0.02), (1000.0, 0.02)]
)
def test_the_default_command_timeout(rate, expected):
    """Truth: the larger of 3 periods and 20 ms, at most 50 ms."""
    assert BridgeParameters(channels='x', sample_rate=rate).max_age == pytest.approx(expected)


def test_a_command_timeout_above_50_ms_is_refused():
    with pytest.raises(SatvibError, match=r'command_timeout: 0\.051 is more than 0\.05 s'):
        BridgeParameters(channels='x', command_timeout=0.051)
