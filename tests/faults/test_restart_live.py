# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Real time: a node stalls, is killed, or is started again in the middle of a run, and the strut comes through it.

One strut of the rig paper_1dof, 200 samples a second, velocity feedback. All spans are counted in samples.
"""

import signal

import numpy as np
import pytest
from satvib_common.phases import Phase, PhasePlan
from satvib_common.struts.applied import Applied
from strut import (
    CONTROLLER,
    IDENTIFIER,
    LAW,
    LONG,
    LOOP,
    PLAN,
    PLANT,
    RATE,
    SOON,
    TIMEOUT,
    Strut,
    shake,
)

# samples: the voltage rises over `return_time`, 0.3 s, and a new integrator, whose corner of 0.5 Hz is a double pole,
# keeps a tenth of its first error when (1 + w t) exp(-w t) = 0.1
SETTLED = RATE * (0.3 + 3.89 / (2.0 * np.pi * 0.5))


def offline(strut, plan=PLAN):
    """The voltage by sample of a controller that was never away: its core, told the samples and models of the run."""
    from satvib_control.core.reception import received_of

    from satvib_control import ControllerCore, ControllerParameters
    from satvib_ident import IirModel

    core = ControllerCore(ControllerParameters(**LAW))
    models = {m.sequence: m for m in strut.models}
    asked, newest = {}, None
    for s in sorted(strut.samples, key=lambda s: s.sequence):
        k = s.sequence
        newest = models.get(k - 1, newest)
        if plan.is_hand_over(k, 50) and newest is not None:
            m = newest
            model = IirModel(np.array(m.a), np.array(m.b), m.delay, m.sample_period)
            size = len(m.a) + len(m.b)
            core.set_model(model, m.converged, m.reason, np.array(m.covariance).reshape(size, -1))
        received = received_of([s], ())
        out = core.step(k, plan, s.upper, s.lower, None, s.upper_clipped, s.lower_clipped, received)
        asked[k] = float(out.voltage)
    return asked


def test_a_stalled_controller_is_silent_and_comes_back(start, probe):
    """Truth: the design. 0 V at once after the time-out, said by plant, controller and topic; then a rise of 0.3 s."""
    strut = Strut(start, probe, SOON)
    strut.until(1200)
    strut.controller.send(signal.SIGSTOP)
    probe.wait(lambda: strut.state() is Applied.SILENT)
    probe.wait(lambda: any('no fresh voltage' in t for t in strut.complaints('/plant_sim')))
    strut.controller.send(signal.SIGCONT)
    probe.wait(lambda: strut.state() is Applied.APPLIED)
    strut.until(strut.k + RATE)
    voltage, state = strut.applied()
    silent = [k for k in state if state[k] is Applied.SILENT]
    assert silent == list(range(silent[0], silent[-1] + 1))
    rising = [k for k in state if state[k] is Applied.RETURNING]
    assert abs(len(rising) - 0.3 * RATE) <= 1
    assert rising[0] == silent[-1] + 1
    assert max(abs(voltage[k]) for k in range(rising[-1], rising[-1] + 40)) > 0.1
    strut.check_no_wrong_voltage()
    probe.wait(lambda: 'got no fresh voltage for too long' in strut.controller.said)
    assert {Applied.SILENT, Applied.RETURNING} <= {s.applied_state for s in strut.states}
    assert '0 V: no fresh voltage for 600 ms' in strut.plant.said
    assert 'applied again' in strut.plant.said
    blocks = [(b.sequence + i, s) for b in strut.blocks for i, s in enumerate(b.states)]
    assert {k for k, s in blocks if s == Applied.SILENT} == set(silent)


def test_after_latch_only_reset_helps(start, probe):
    """Truth: the design of `after_silence: latch`."""
    from std_srvs.srv import Trigger

    strut = Strut(start, probe, SOON, after_silence='latch')
    strut.until(1200)
    strut.controller.send(signal.SIGSTOP)
    probe.wait(lambda: strut.state() is Applied.LATCHED)
    strut.controller.send(signal.SIGCONT)
    strut.until(strut.k + 2 * RATE)
    assert strut.state() is Applied.LATCHED
    assert strut.samples[-1].applied == 0.0
    assert any('call ~/reset' in text for text in strut.complaints('/plant_sim'))
    assert probe.call(Trigger, '/plant_sim/reset', Trigger.Request()).success
    probe.wait(lambda: strut.state() is Applied.APPLIED)


def check_model(strut, plan):
    """The last model is that of an identifier that is told what the coil got, sample by sample; every bit."""
    from satvib_ident import IdentifierCore, IdentifierParameters

    core = IdentifierCore(IdentifierParameters(**LOOP))
    last = strut.models[-1]
    found = None
    for s in sorted(strut.samples, key=lambda s: s.sequence):
        if s.sequence <= last.sequence:
            ends = np.asarray(s.upper_clipped)
            applied = np.asarray(s.applied if s.sequence else 0.0)
            phase = plan.at(s.sequence)
            found = core.step(s.sequence, phase, np.asarray(s.upper), applied, None, ends)
    assert found.a.tolist() == list(last.a)
    assert found.b.tolist() == list(last.b)


@pytest.mark.parametrize(
    ('phase', 'at', 'end'),
    [
        pytest.param('CALIBRATE', 150, signal.SIGINT, marks=pytest.mark.long),
        pytest.param('IDENTIFY', 600, signal.SIGKILL, marks=pytest.mark.long),
        ('CONTROL', 2200, signal.SIGKILL),
        pytest.param('CONTROL', 2200, signal.SIGINT, marks=pytest.mark.long),
    ],
)
def test_a_controller_that_is_started_again_goes_on(start, probe, phase, at, end):
    """Truth: the core of a controller that was never away, told the same samples and models.

    The voltage is right where it differs from that by less than a tenth of its largest value. From the first fresh
    answer of the new process on, that takes at most `SETTLED`, and what the machine was away. Until then the coil has
    0 V or a share of what is asked.
    """
    plan = PLAN if phase == 'CONTROL' else LONG
    strut = Strut(start, probe, plan)
    strut.until(at)
    strut.controller.send(end)
    strut.controller.wait()
    probe.wait(lambda: strut.state() is Applied.SILENT)
    again = start(*CONTROLLER, '/strut_1', **LAW)
    probe.wait(lambda: strut.state() is Applied.APPLIED)
    back = strut.k
    strut.until(strut.k + 2 * RATE)
    probe.wait(lambda: strut.states[-1].sequence >= strut.k - 20)
    wanted = offline(strut, plan)
    asked = {v.sequence: v.voltage for v in strut.voltages}
    _, state = strut.applied()
    for seen in strut.states:
        assert seen.phase == plan.at(seen.sequence)
    first = 1 + max(k for k, s in state.items() if s is Applied.SILENT and k < back)
    span = range(first, first + 2 * RATE - 50)
    limit = 0.1 * max(abs(wanted[k]) for k in span) + 1e-9
    right = {
        k: state[k] is Applied.APPLIED and abs(asked.get(k, np.nan) - wanted[k]) <= limit
        for k in range(first, first + 2 * RATE)
    }
    begin = next(k for k in span if np.mean([right[i] for i in range(k, k + 50)]) > 0.9)
    away = strut.away(first, begin)
    print(f'{phase}: right {(begin - first) / RATE:g} s after the first fresh answer, away {away}')
    assert begin - first < SETTLED + away
    strut.check_no_wrong_voltage()
    check_model(strut, plan)
    assert again.popen.poll() is None


@pytest.mark.parametrize(
    ('phase', 'at'), [('IDENTIFY', 400), pytest.param('CONTROL', 2200, marks=pytest.mark.long)]
)
def test_an_identifier_that_is_started_again_harms_nothing(start, probe, phase, at):
    """Truth: the samples. The controller goes on to answer them; a new model needs the bias, which it has.

    The bias of the first identifier was measured in CALIBRATE; that of the second one is the same number. The second
    one is started when the others have found the first one's end: with shared memory that took them two seconds.
    """
    strut = Strut(start, probe, PLAN if phase == 'CONTROL' else LONG)
    strut.until(at)
    bias = strut.states[-1].bias_upper
    strut.identifier.send(signal.SIGKILL)
    strut.identifier.wait()
    strut.until(strut.k + 3 * RATE)
    start(*IDENTIFIER, '/strut_1', **LOOP)
    began, newest = strut.k, strut.models
    if phase == 'IDENTIFY':
        # the first models may come before the bias does
        probe.wait(lambda: newest[-1].sequence > began and newest[-1].bias == bias)
    else:
        strut.until(began + 2 * RATE)
    _, state = strut.applied()
    assert not {Applied.LATCHED, Applied.WAITING} & {s for k, s in state.items() if k >= at}
    assert {s.fault for s in strut.states} == {False}


def test_a_plant_that_is_started_again_begins_the_run_again(start, probe):
    """Truth: the schedule, which is still there: sample 0, STANDBY, CALIBRATE with new biases, then the excitation.

    In STANDBY the controller finds the new plant; a busy machine needs most of a second for that.
    """
    plan = PhasePlan(PLAN.phases, (0, 400, 600, 1500), 0)
    strut = Strut(start, probe, plan)
    strut.until(700)
    strut.plant.send(signal.SIGKILL)
    strut.plant.wait()
    count = len(strut.samples)
    setting = {'disturbance': shake(plan), 'seed': 2, 'command_timeout': TIMEOUT}
    start(*PLANT, rig='paper_1dof', lockstep=False, **setting)
    probe.wait(lambda: len(strut.samples) > count and strut.k >= 900)
    second = strut.samples[count:]
    answers = [s for s in strut.states if s.header.stamp.sec >= second[0].header.stamp.sec]
    assert {s.phase for s in answers if 10 < s.sequence < 390} == {Phase.STANDBY}
    assert {s.phase for s in answers if 610 < s.sequence < 890} == {Phase.IDENTIFY}
    rest = [s.upper for s in second if 400 <= s.sequence < 600]
    newest = answers[-1]
    assert newest.bias_upper == pytest.approx(np.mean(rest), abs=0.01)
    assert {Applied(s.applied_state) for s in second if s.sequence > 620} == {Applied.APPLIED}
    assert max(abs(s.applied) for s in second if s.sequence > 620) == 10.0
