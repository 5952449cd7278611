# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_control.core.controller import ControllerCore
from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.registry import make_law
from satvib_control.laws.sum import LawSum
from satvib_ident.excitation import make_excitation
from satvib_ident.models.iir_model import IirModel

RATE = 100.0
PLAN = PhasePlan(
    (Phase.CALIBRATE, Phase.IDENTIFY, Phase.STANDBY, Phase.CONTROL), (0, 50, 60, 70), 1000
)
ALWAYS = PhasePlan((Phase.CONTROL,), (0,))


class Proportional(BasicLaw):
    """The law of the README: a virtual mass."""

    def step(self, x: LawInput, phase: Phase) -> Array:  # noqa: ARG002
        return -2.0 * x.upper


class Broken(BasicLaw):
    def step(self, x: LawInput, phase: Phase) -> Array:  # noqa: ARG002
        return np.where(x.sequence == 5, np.nan, 1.0) + np.zeros(self.shape)


class Spy(BasicLaw):
    """Keeps what it is given."""

    def __init__(self, parameters, dt, shape=()):
        super().__init__(parameters, dt, shape)
        self.given = []

    def step(self, x: LawInput, phase: Phase) -> Array:
        self.given.append((phase, x))
        return np.full(self.shape, 10.0)


def core_with(settings, cls, shape=(), **changes):
    """A core with a law of this file; switched on at once unless said otherwise."""
    p = settings(**({'sample_rate': RATE, 'law': 'off', 'switch_on_time': 0.0} | changes))
    core = ControllerCore(p, shape)
    core.law = cls(p, core.dt, shape)
    return core


def test_phases_have_their_voltages(settings):
    """Truth: the schedule: 0 V, the excitation of the strut by name, 0 V, the law."""
    core = core_with(settings, Proportional, strut=1, excitation_amplitude=4.0)
    signal = make_excitation('squares', amplitude=4.0, dt=0.01, strut=1, struts=3)
    for k in range(100):
        out = core.step(k, PLAN, np.array(0.5), np.array(0.1))
        phase = PLAN.at(k)
        assert out.phase == phase
        if phase == Phase.IDENTIFY:
            assert out.voltage == out.reference == signal.at(k - 50)
        elif phase == Phase.CONTROL:
            assert out.voltage == pytest.approx(0.0, abs=1e-12)  # 0.5 is the bias
        else:
            assert out.voltage == 0.0
    assert out.bias_upper == pytest.approx(0.5)
    assert out.bias_lower == pytest.approx(0.1)
    out = core.step(100, PLAN, np.array(1.5), np.array(0.1))
    assert out.voltage == pytest.approx(-2.0)


def test_the_bias_is_frozen_after_calibration(settings):
    core = core_with(settings, Proportional)
    for k in range(70):
        core.step(k, PLAN, np.array(0.2 if k < 50 else 5.0), np.array(0.0))
    assert core.calibration_upper.mean == pytest.approx(0.2)


def test_a_strut_that_was_not_at_rest_is_refused(settings):
    """A standard deviation of 1.6 m/s^2 in CALIBRATE: 0 V for good, and the reason; the quiet strut goes on."""
    core = core_with(settings, Proportional, shape=(2,))
    for k in range(100):
        swing = np.array([2.0 * (-1.0) ** k, 0.0]) if k < 50 else np.array([1.0, 1.0])
        out = core.step(k, PLAN, swing, np.zeros(2))
        if k >= 50:
            assert out.voltage[0] == 0.0
    assert list(out.fault) == [True, False]
    assert out.voltage[1] == -2.0
    assert out.reason_text((0,)) == 'fault: the upper sensor was not at rest in CALIBRATE'


@pytest.mark.parametrize(
    ('bias', 'swing', 'reason'), [(0.0, 2.0, 'not at rest'), (1e4, 0.0, 'more than bias_limit')]
)
def test_a_reset_cannot_give_a_bias_and_another_calibration_can(settings, bias, swing, reason):
    """Truth: without a bias the law would see 10^4 m/s^2 for ever. Only CALIBRATE at rest releases that strut."""
    plan = PhasePlan(
        (Phase.CALIBRATE, Phase.CONTROL, Phase.CALIBRATE, Phase.CONTROL), (0, 50, 100, 150), 200
    )
    core = core_with(settings, Proportional, shape=(2,))
    for k in range(200):
        wrong = bias + swing * (-1.0) ** k if k < 50 else 1.0
        out = core.step(k, plan, np.array([wrong, 1.0]), np.zeros(2))
        if k == 75:
            assert not core.reset()
        if 50 <= k <= 160:
            assert out.voltage[0] == 0.0
            assert out.fault.tolist() == [True, False]
            assert reason in out.reason_text((0,))
        if k == 160:
            assert core.reset()
    assert out.voltage.tolist() == [0.0, 0.0]
    assert not out.fault.any()
    np.testing.assert_allclose(core.calibration_upper.mean, 1.0)


def test_a_missing_sample_gives_nothing_and_many_latch_a_fault(settings):
    core = core_with(settings, Proportional, loss_limit=3)
    uppers = [1.0, np.nan, 1.0, np.inf, np.nan, 1.0, np.nan, np.nan, np.nan, 1.0]
    outs = [core.step(k, ALWAYS, np.array(y), np.array(0.0)) for k, y in enumerate(uppers)]
    assert [float(o.voltage) for o in outs] == [-2.0, 0.0, -2.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0]
    assert [bool(o.fault) for o in outs] == [False] * 8 + [True] * 2
    assert outs[1].reason_text() == '0 V: the upper acceleration is missing'
    assert outs[-1].reason_text() == 'fault: the upper acceleration was missing for too long'
    core.reset()
    assert core.step(10, ALWAYS, np.array(1.0), np.array(0.0)).voltage == -2.0


def test_a_demand_that_is_not_finite_latches_a_fault(settings):
    core = core_with(settings, Broken)
    outs = [core.step(k, ALWAYS, np.array(0.0), np.array(0.0)) for k in range(8)]
    assert [float(o.voltage) for o in outs] == [1.0] * 5 + [0.0] * 3
    assert outs[-1].fault
    assert outs[-1].reason_text() == 'fault: the law asked for a voltage that is not finite'


def test_the_limit_and_the_slew_limit_hold_and_the_law_is_given_what_is_left(settings):
    """Truth: 10 V asked, 3 V allowed, 100 V/s at 100 Hz: 1, 2, 3, 3 V."""
    core = core_with(settings, Spy, voltage_limit=3.0, slew_limit=100.0, excitation_amplitude=1.0)
    voltages = [float(core.step(k, ALWAYS, np.array(0.0), np.array(0.0)).voltage) for k in range(4)]
    assert voltages == [1.0, 2.0, 3.0, 3.0]
    assert [float(x.applied) for _, x in core.law.given] == [0.0, 1.0, 2.0, 3.0]
    assert [bool(x.saturated) for _, x in core.law.given] == [False, True, True, True]


def test_control_fades_in(settings):
    """Truth: a fifth of a second at 100 Hz is 20 equal steps."""
    core = core_with(settings, Spy, switch_on_time=0.2)
    voltages = [
        float(core.step(k, ALWAYS, np.array(0.0), np.array(0.0)).voltage) for k in range(25)
    ]
    np.testing.assert_allclose(voltages, np.minimum(np.arange(1, 26) / 20.0, 1.0) * 10.0)


def test_stop_latches_zero_until_reset(settings):
    core = core_with(settings, Proportional)
    assert core.step(0, ALWAYS, np.array(1.0), np.array(0.0)).voltage == -2.0
    core.stop()
    out = core.step(1, ALWAYS, np.array(1.0), np.array(0.0))
    assert (float(out.voltage), out.reason_text()) == (0.0, 'fault: stopped from outside')
    core.reset()
    assert core.step(2, ALWAYS, np.array(1.0), np.array(0.0)).voltage == -2.0


def test_gaps_are_counted_repeats_answered_alike_and_a_restart_begins_again(settings):
    core = core_with(settings, Proportional)
    core.step(0, ALWAYS, np.array(1.0), np.array(0.0))
    out = core.step(5, ALWAYS, np.array(2.0), np.array(0.0))
    assert out.missed_samples == 4
    assert core.step(5, ALWAYS, np.array(9.0), np.array(0.0)) is out
    core.stop()
    core.step(6, ALWAYS, np.array(2.0), np.array(0.0))
    out = core.step(0, ALWAYS, np.array(1.0), np.array(0.0))
    assert not out.fault
    assert out.sequence == 0


def test_new_settings_are_taken_while_running(settings):
    core = core_with(settings, Spy)
    assert core.step(0, ALWAYS, np.array(0.0), np.array(0.0)).voltage == 10.0
    core.apply(core.parameters.replace(voltage_limit=2.0, excitation_amplitude=2.0))
    assert core.step(1, ALWAYS, np.array(0.0), np.array(0.0)).voltage == 2.0


@pytest.mark.parametrize(
    ('model', 'trusted', 'why', 'given'),
    [
        (
            IirModel([-1.2], [1.0], 1, 0.01),
            True,
            '',
            'the identified model is not stable: not taken',
        ),
        (
            IirModel([np.nan], [1.0], 1, 0.01),
            True,
            '',
            'the identified model is not stable: not taken',
        ),
        (
            IirModel([0.5], [1.0], 0, 0.01),
            True,
            '',
            'the identified model has no delay, so no law can use it: not taken',
        ),
        (IirModel([0.5], [1.0], 1, 0.01), False, 'not excited', 'not excited'),
    ],
)
def test_a_model_that_cannot_be_used_is_refused_by_name(settings, model, trusted, why, given):
    core = ControllerCore(settings(sample_rate=RATE))
    core.set_model(model, trusted, why)
    out = core.step(0, ALWAYS, np.array(1.0), np.array(0.0))
    assert out.voltage == 0.0
    assert out.reason_text() == given


def test_a_model_that_is_not_new_is_not_designed_for_again(settings):
    """Truth: what the law is given: nothing in IDENTIFY, then each new model once, and for the struts it is new for."""

    class Listener(Spy):
        def set_model(self, model, trusted, covariance=None):  # noqa: ARG002
            self.given.append(trusted.tolist())

        def step(self, x, phase):  # noqa: ARG002
            return np.zeros(self.shape)

    core = core_with(settings, Listener, shape=(2,))
    plan = PhasePlan((Phase.IDENTIFY, Phase.CONTROL), (0, 10), 100)
    first = IirModel([[0.5], [0.4]], [[1.0], [1.0]], 1, 0.01)
    second = IirModel([[0.5], [0.3]], [[1.0], [1.0]], 1, 0.01)
    for k in range(60):
        if k % 10 == 0:
            core.set_model(first if k < 40 else second, [True, k > 20])
        core.step(k, plan, np.zeros(2), np.zeros(2))
    assert core.law.given == [[True, False], [False, True], [False, True]]


def test_the_whole_paper_sequence_has_the_same_bits_in_any_batch(
    make_isolator, make_loop, settings, paper_plan
):
    """Truth: each strut alone, and a batch (2, 3); every voltage and gain equal to the last bit."""
    plan = paper_plan(RATE, (0.0, 0.5, 1.0, 2.0, 2.5), 4.0)
    models = [make_isolator(RATE, wn=w) for w in (120.0, 131.0, 140.0)]
    batch = IirModel(np.stack([m.a for m in models]), np.stack([m.b for m in models]), 1, 1 / RATE)
    p = settings(sample_rate=RATE, adapt_in_control=True)
    d = np.random.default_rng(7).standard_normal((400, 3)) * 0.1
    row = make_loop(p, batch, plan, (3,))
    _, together = row.run(400, d)
    wide = make_loop(p, batch, plan, (2, 3))
    _, many = wide.run(400, np.stack([d, d], axis=1))
    for i, model in enumerate(models):
        loop = make_loop(p.replace(strut=i), model, plan)
        _, alone = loop.run(400, d[:, i])
        np.testing.assert_array_equal(together[:, i], alone)
        np.testing.assert_array_equal(many[:, 1, i], alone)
        assert loop.core.law.state.ki == row.core.law.state.ki[i] == wide.core.law.state.ki[1, i]
    assert np.max(np.abs(together[300:])) > 0.0


def test_the_output_fills_the_message(make_isolator, make_loop, settings, paper_plan):
    """Truth: the fields of satvib_msgs/ControllerState that do not come from the node."""
    loop = make_loop(settings(sample_rate=RATE), make_isolator(RATE), paper_plan(RATE))
    _, out = loop.step()
    fields = out.fields()
    node = {'header', 'time_step', 'compute_time', 'applied', 'applied_state'}
    path = Path(__file__).parents[3] / 'satvib_msgs/msg/ControllerState.msg'
    names = {
        line.split()[1]
        for line in path.read_text().splitlines()
        if line.strip() and not line.startswith('#')
    }
    assert set(fields) == names - node
    assert all(isinstance(v, int | float | bool | str) for v in fields.values())


@pytest.mark.parametrize(
    ('change', 'message'),
    [
        ({'law': 'velocity_fedback'}, "law: 'velocity_fedback' is not one of"),
        ({'law': 'velocity_feedback+nothing'}, "law: 'nothing' is not one of"),
        ({'law': 'no.such:Law'}, "law: 'no.such:Law' cannot be loaded"),
        ({'law': 'satvib_control.laws.reasons:reason'}, 'has no method step'),
        ({'excitation_amplitude': 30.0}, 'excitation_amplitude: 30.0 V is more than voltage_limit'),
        (
            {'excitation_frequencies': (1.0, 50.0)},
            'excitation_frequencies: 50.0 Hz is not below half',
        ),
        ({'velocity_corner': 60.0}, 'velocity_corner: 60.0 Hz is not below half'),
        ({'sample_rate': 0.0}, 'sample_rate: 0.0 is not above 0.0 Hz'),
        ({'adapted_gains': ('ki', 'kx')}, "adapted_gains: 'kx' is not one of kp, ki, kd"),
        ({'modulus_margin': 1.0}, 'modulus_margin: 1.0 is more than 0.95'),
    ],
)
def test_bad_settings_are_refused_in_one_line(settings, change, message):
    with pytest.raises(SatvibError, match=message) as caught:
        settings(**({'sample_rate': RATE} | change))
    assert '\n' not in str(caught.value)


def test_an_excitation_that_does_not_exist_is_refused(settings):
    with pytest.raises(SatvibError, match='excitation'):
        ControllerCore(settings(sample_rate=RATE, excitation='squars'))


def test_laws_are_made_by_name_and_sums_too(settings):
    p = settings(sample_rate=RATE)
    assert type(make_law('velocity_feedback', p, 0.01)).__name__ == 'VelocityFeedback'
    law = make_law('velocity_feedback + model_reference', p, 0.01)
    assert isinstance(law, LawSum)
    assert [type(part).__name__ for part in law.parts] == ['VelocityFeedback', 'ModelReference']


def test_the_law_of_the_documentation_runs(
    make_isolator, make_loop, settings, monkeypatch, tmp_path
):
    """Truth: docs/laws.md itself: its code, as a module, chosen by name; a virtual mass of either polarity."""
    path = Path(__file__).parents[4] / 'docs' / 'laws.md'
    code = path.read_text(encoding='utf-8').split('```python\n')[1].split('```')[0]
    (tmp_path / 'law_of_the_docs.py').write_text(code, encoding='utf-8')
    monkeypatch.syspath_prepend(tmp_path)
    p = settings(
        sample_rate=RATE,
        law='law_of_the_docs:VirtualMass',
        switch_on_time=0.0,
        excitation_amplitude=0.0,
    )
    plan = PhasePlan((Phase.STANDBY, Phase.IDENTIFY, Phase.CONTROL), (0, 1, 2), 100)
    loop = make_loop(p, make_isolator(RATE), plan)
    loop.run(5)
    y, out = loop.step(0.5)
    assert abs(float(out.voltage)) == pytest.approx(0.2 * abs(float(y)))


def test_dither_is_added_in_control_only(settings):
    """Truth: the excitation of IDENTIFY at another amplitude, faded in like the law; 0 V elsewhere."""
    p = settings(sample_rate=100.0, law='off', dither=0.5, excitation_amplitude=10.0)
    plan = PhasePlan((Phase.IDENTIFY, Phase.STANDBY, Phase.CONTROL), (0, 100, 150), 300)
    core = ControllerCore(p)
    u = np.array([float(core.step(k, plan, 0.0, 0.0).voltage) for k in range(300)])
    assert np.abs(u[:100]).max() == pytest.approx(10.0)
    assert not u[100:150].any()
    faded = round(p.switch_on_time * p.sample_rate)
    np.testing.assert_allclose(u[150 + faded : 250], 0.05 * u[faded:100], rtol=1e-12)
