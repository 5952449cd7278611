# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from satvib_common.phases import Phase
from satvib_control.laws.base import LawInput
from satvib_control.laws.model_reference.law import ModelReference
from satvib_control.laws.reasons import text_of
from satvib_control.model_analysis.transfer import broadcast_model
from scipy.signal import lfilter

RATE = 200.0
TINY = 1e-30


def sample(k, y=0.0, applied=0.0, saturated=False, valid=True, shape=()):
    def full(value, kind=float):
        return np.full(shape, value, dtype=kind)

    return LawInput(
        k, full(y), full(np.nan), full(applied), full(saturated, bool), full(valid, bool)
    )


def polynomials(model, parameters):
    """A Fa, B Fa, B Fb, B D Fa by numpy.convolve, of one length; F by SciPy's bilinear transform of its H(s)."""
    from scipy.signal import bilinear

    w = 2 * np.pi * parameters.velocity_corner
    fb, fa = bilinear([1.0, 0.0], [1.0, 2 * w, w * w], 1.0 / model.dt)
    b = np.concatenate([np.zeros(model.delay), model.b])
    a = np.concatenate([[1.0], model.a])
    rows = [np.convolve(a, fa), np.convolve(b, fa), np.convolve(b, fb)]
    rows.append(np.convolve(np.convolve(b, fa), [1 / model.dt, -1 / model.dt]))
    length = max(map(len, rows))
    return [np.pad(row, (0, length - len(row))) for row in rows]


def closed(rows, kp, ki, kd):
    """Numerator of H, denominator."""
    num = kp * rows[1] + ki * rows[2]
    return num, rows[0] + num + kd * rows[3]


def law_with(settings, model, **changes):
    p = settings(
        sample_rate=1.0 / model.dt, adaptation_rate=0.0, reference_excitation='squares', **changes
    )
    law = ModelReference(p, model.dt)
    law.set_model(broadcast_model(model, ()), np.array(True))
    return law


def test_the_sensitivity_is_the_exact_derivative_of_the_closed_loop(make_isolator, settings):
    """dH/dK_i, Eq. (41) put right. Truth: the closed loop with K_i + i 1e-30 (complex step), 1e-9."""
    model = make_isolator(RATE)
    law = law_with(settings, model, gain_i=60.0)
    eta, u_c = [], []
    for k in range(400):
        law.step(sample(k), Phase.ADAPT)
        eta.append(float(law.state.sensitivity))
        u_c.append(float(law.state.reference))
    num, den = closed(polynomials(model, law.parameters), 0.0, 60.0 + 1j * TINY, 0.0)
    truth = lfilter(num, den, np.array(u_c, dtype=complex)).imag / TINY
    assert np.max(np.abs(truth)) > 1e-4
    np.testing.assert_allclose(eta, truth, atol=1e-9 * np.max(np.abs(truth)))


@pytest.mark.parametrize('gain', ['kp', 'ki', 'kd'])
def test_each_of_the_three_sensitivities_is_exact(make_isolator, settings, gain):
    """Truth: complex step of the closed loop with all three gains in force, 1e-8."""
    model = make_isolator(RATE)
    gains = {'gain_p': 0.3, 'gain_i': 40.0, 'gain_d': 2e-4}
    law = law_with(settings, model, adapted_gains=(gain,), **gains)
    assert float(law.state.ki) == 0.0  # shown from the first step on
    eta, u_c = [], []
    for k in range(400):
        law.step(sample(k), Phase.ADAPT)
        eta.append(float(law.state.sensitivity))
        u_c.append(float(law.state.reference))
    steps = {'kp': 0.0, 'ki': 0.0, 'kd': 0.0} | {gain: 1j * TINY}
    kp, ki, kd = 0.3 + steps['kp'], 40.0 + steps['ki'], 2e-4 + steps['kd']
    assert (float(law.state.kp), float(law.state.ki), float(law.state.kd)) == (0.3, 40.0, 2e-4)
    num, den = closed(polynomials(model, law.parameters), kp, ki, kd)
    truth = lfilter(num, den, np.array(u_c, dtype=complex)).imag / TINY
    np.testing.assert_allclose(eta, truth, atol=1e-8 * np.max(np.abs(truth)))


def test_in_control_the_sensitivity_is_that_of_the_vibration_itself(make_isolator, settings):
    """dy/dK_i of y = S d. Truth: complex step through S on a random disturbance, 1e-9."""
    model = make_isolator(RATE)
    law = law_with(settings, model, gain_i=60.0)
    d = np.random.default_rng(4).standard_normal(500)
    rows = polynomials(model, law.parameters)
    _, den = closed(rows, 0.0, 60.0 + 1j * TINY, 0.0)
    y = lfilter(rows[0], den, d.astype(complex))
    eta = []
    for k in range(500):
        law.step(sample(k, y.real[k]), Phase.CONTROL)
        eta.append(float(law.state.sensitivity))
    truth = y.imag / TINY
    np.testing.assert_allclose(eta, truth, atol=1e-9 * np.max(np.abs(truth)))


@pytest.mark.parametrize('model_kind', ['identified', 'designed'])
def test_in_adapt_the_gain_finds_the_wanted_one(
    make_isolator, make_loop, settings, paper_plan, model_kind
):
    """Truth: the gain that `damping_gain` computes for the model; 5 % after 6 s of the identified reference.

    The designed reference is not attained exactly (delay, filter), so there the test asks for a gain on the way.
    """
    from satvib_common.signals.integrator import leaky_integrator
    from satvib_control.model_analysis.dominant_mode import damping_gain
    from satvib_control.model_analysis.gain_bounds import gain_bounds

    model = make_isolator(RATE, zeta=0.3)
    p = settings(sample_rate=RATE, reference_damping=0.6, reference_model=model_kind)
    loop = make_loop(p, model, paper_plan(RATE, (0.0, 0.1, 1.0, 7.0, 7.5), 8.0))
    loop.run(int(6.9 * RATE))
    fb, fa = leaky_integrator(p.velocity_corner, model.dt)
    wanted, _ = damping_gain(model, fb, fa, gain_bounds(model, fb, fa, 0.5).maximum, 0.6)
    found = float(loop.core.law.state.ki)
    if model_kind == 'identified':
        assert found == pytest.approx(float(wanted), rel=0.05)
    else:
        assert 0.4 * float(wanted) < found < 1.6 * float(wanted)


def test_a_negative_polarity_gives_the_mirrored_gain(
    make_isolator, make_loop, settings, paper_plan
):
    """Truth: symmetry; the same gains with the opposite sign when nothing but u_c moves; 1e-9."""
    plan = paper_plan(RATE, (0.0, 0.1, 1.0, 3.0, 3.5), 4.0)
    found = []
    for gain in (1.2, -1.2):
        loop = make_loop(
            settings(sample_rate=RATE, excitation_amplitude=0.0),
            make_isolator(RATE, gain=gain),
            plan,
        )
        loop.run(int(2.9 * RATE))
        found.append(float(loop.core.law.state.ki))
    assert found[0] > 10.0
    assert found[1] == pytest.approx(-found[0], rel=1e-9)


def test_the_gain_never_leaves_its_interval(make_isolator, make_loop, settings, paper_plan):
    """A rate far too high, in a plant that differs by 30 %: the gain stays inside, the output stays finite."""
    model, plant = make_isolator(RATE), make_isolator(RATE, wn=170.0, zeta=0.5, gain=1.5)
    p = settings(
        sample_rate=RATE, adaptation_rate=100.0, reference_damping=5.0, adapt_in_control=True
    )
    loop = make_loop(p, plant, paper_plan(RATE), identified=model)
    noise = np.random.default_rng(1).standard_normal(int(10 * RATE)) * 0.3
    low, high = np.inf, -np.inf
    for d in noise:
        y, _ = loop.step(d)
        low, high = (
            min(low, float(loop.core.law.state.ki)),
            max(high, float(loop.core.law.state.ki)),
        )
        assert abs(y) < 50.0
    assert low >= 0.0
    assert high <= float(loop.core.law.state.ki_max)
    assert high > 10.0


def test_in_control_it_descends_the_power_of_the_vibration(
    make_isolator, make_loop, settings, paper_plan
):
    """Truth: |S|^2 at 8 Hz falls with K_i up to the bound (by the model's response), so the gain must climb to it."""
    model = make_isolator(RATE)
    p = settings(sample_rate=RATE, adapt_in_control=True, adaptation_rate=20.0)
    plan = paper_plan(RATE, (0.0, 0.1, 0.2, 0.3, 1.0), 30.0)
    loop = make_loop(p, model, plan)
    t = np.arange(int(20 * RATE)) / RATE
    y, _ = loop.run(len(t), np.sin(2 * np.pi * 8.0 * t))
    state = loop.core.law.state
    assert float(state.ki) > 0.95 * float(state.ki_max)
    before, after = y[int(0.4 * RATE) : int(0.9 * RATE)], y[-int(2 * RATE) :]
    assert after.std() < 0.75 * before.std()


def test_nothing_is_learnt_from_silence(make_isolator, make_loop, settings, paper_plan):
    loop = make_loop(
        settings(sample_rate=RATE, adapt_in_control=True),
        make_isolator(RATE),
        paper_plan(RATE, (0.0, 0.1, 0.2, 0.3, 0.4), 2.0),
    )
    loop.run(int(0.4 * RATE))
    before = float(loop.core.law.state.ki)
    loop.plant.reset()
    loop.core.law.reset()
    for _ in range(100):
        _, out = loop.step(0.0)
    assert float(loop.core.law.state.ki) == 0.0
    assert before >= 0.0
    assert not out.adapting
    assert out.reason_text() == 'adaptation frozen: not excited'


def test_a_saturated_voltage_freezes_the_gain(make_isolator, settings):
    law = law_with(settings, make_isolator(RATE), gain_i=20.0, adapt_in_control=True)
    law.apply(law.parameters.replace(adaptation_rate=50.0))
    rng = np.random.default_rng(2)
    for k in range(200):
        law.step(sample(k, rng.standard_normal(), saturated=True), Phase.CONTROL)
    assert float(law.state.ki) == 20.0
    assert text_of(law.state.reason) == 'adaptation frozen: the voltage is saturated'
    for k in range(200, 400):
        law.step(sample(k, rng.standard_normal()), Phase.CONTROL)
    assert float(law.state.ki) != 20.0


def test_the_first_samples_do_not_throw_the_gain(make_isolator, make_loop, settings, paper_plan):
    """It rings from IDENTIFY, the model is 7 % off. Truth: at most gamma times its size a second."""
    loop = make_loop(
        settings(sample_rate=RATE),
        make_isolator(RATE, wn=140.0, zeta=0.3),
        paper_plan(RATE),
        identified=make_isolator(RATE, wn=131.0, zeta=0.3),
    )
    gains = []
    for _ in range(int(4.0 * RATE)):
        loop.step(0.0)
        gains.append(float(loop.core.law.state.ki))
    largest = 5.0 / RATE * float(loop.core.law.state.ki_max)
    assert np.max(np.abs(np.diff(gains))) <= largest * (1.0 + 1e-12)
    assert gains[-1] > 0.0


def test_without_an_adaptation_the_state_says_why_nothing_happens(
    make_isolator, make_loop, settings
):
    from satvib_common.phases import PhasePlan

    plan = PhasePlan((Phase.STANDBY, Phase.IDENTIFY, Phase.CONTROL), (0, 1, 2), 100)
    loop = make_loop(settings(sample_rate=RATE), make_isolator(RATE), plan)
    loop.run(10)
    shown = text_of(loop.core.law.state.reason)
    assert shown == 'the gain is still 0: no ADAPT so far, and adapt_in_control is off'


def test_without_a_model_the_voltage_is_nothing_and_says_so(
    make_isolator, make_loop, settings, paper_plan
):
    loop = make_loop(
        settings(sample_rate=RATE), make_isolator(RATE), paper_plan(RATE), trusted=False
    )
    loop.run(int(2.0 * RATE))
    _, u = loop.run(int(7.9 * RATE), np.random.default_rng(0).standard_normal(int(7.9 * RATE)))
    assert np.all(u[int(1.1 * RATE) :] == 0.0)
    assert loop.core.law.state.reason == loop.core.law.state.reason
    assert text_of(loop.core.law.state.reason) == 'no trusted identified model: 0 V'


def test_the_reference_stays_within_its_voltage(make_isolator, make_loop, settings, paper_plan):
    """Truth: the setting, 5 V at the wanted gain; a square wave's edges may pass it by a third."""
    loop = make_loop(
        settings(sample_rate=RATE, reference_damping=1.0), make_isolator(RATE), paper_plan(RATE)
    )
    loop.run(int(3.0 * RATE))
    _, u = loop.run(int(2.0 * RATE))
    assert 2.0 < np.max(np.abs(u)) < 5.0 * 4.0 / 3.0


def test_several_gains_adapt_together_and_keep_the_margin(
    make_isolator, make_loop, settings, paper_plan
):
    """Truth: max |S| of the final gains by brute force on the model, 2 within 2 %; and -4.5 dB is in reach there."""
    model = make_isolator(RATE)
    p = settings(
        sample_rate=RATE,
        adapted_gains=('kp', 'ki', 'kd'),
        adapt_in_control=True,
        adaptation_rate=5.0,
    )
    loop = make_loop(p, model, paper_plan(RATE, (0.0, 0.1, 0.2, 0.3, 0.5), 30.0))
    t = np.arange(int(20 * RATE)) / RATE
    y, _ = loop.run(
        len(t),
        np.sin(2 * np.pi * 8.0 * t) + 0.01 * np.random.default_rng(5).standard_normal(len(t)),
    )
    s = loop.core.law.state
    rows = polynomials(model, p)
    _, den = closed(rows, float(s.kp), float(s.ki), float(s.kd))
    zi = np.exp(-1j * np.linspace(1e-3, np.pi, 20001))
    peak = np.max(np.abs(np.polyval(rows[0][::-1], zi) / np.polyval(den[::-1], zi)))
    assert np.max(np.abs(np.roots(den))) < 1.0
    assert peak < 2.04
    assert float(s.kp) != 0.0
    assert y[-400:].std() < 0.65 * np.sqrt(0.5)


@pytest.mark.parametrize('rule', ['normalized', 'mit', 'lyapunov'])
def test_a_batch_of_several_gains_has_the_bits_of_its_items(
    make_isolator, make_loop, settings, paper_plan, rule
):
    """Truth: each strut alone; voltages and gains equal to the last bit."""
    from satvib_ident.models.iir_model import IirModel

    models = [make_isolator(RATE, wn=w) for w in (110.0, 131.0, 150.0)]
    batch = IirModel(np.stack([m.a for m in models]), np.stack([m.b for m in models]), 1, 1 / RATE)
    p = settings(
        sample_rate=RATE,
        adapted_gains=('kp', 'ki', 'kd'),
        adapt_in_control=True,
        adaptation_rule=rule,
        adaptation_leakage=0.01,
        adaptation_dead_zone=0.01,
    )
    plan = paper_plan(RATE, (0.0, 0.1, 0.3, 0.8, 1.0), 2.0)
    d = 0.3 * np.random.default_rng(8).standard_normal((400, 3))
    row = make_loop(p, batch, plan, (3,))
    _, together = row.run(400, d)
    for i, model in enumerate(models):
        loop = make_loop(p.replace(strut=i), model, plan)
        _, alone = loop.run(400, d[:, i])
        np.testing.assert_array_equal(together[:, i], alone)
        for name in ('kp', 'ki', 'kd'):
            assert getattr(row.core.law.state, name)[i] == getattr(loop.core.law.state, name)
    assert np.max(np.abs(together[300:])) > 0.0


@pytest.mark.parametrize('seconds', [60, pytest.param(600, marks=pytest.mark.long)])
@pytest.mark.parametrize('gains', [('ki',), ('kp', 'ki', 'kd')], ids=['ki', 'pid'])
def test_adapting_for_long_the_gains_stay_and_the_voltage_does_not_drift(
    make_isolator, make_loop, settings, paper_plan, seconds, gains
):
    """Its worst case: adapting all the time on a tone, noise and a bias of 1 m/s^2, in a plant 10 % off its model.

    Truth: gains within the bounds of the model, no blow-up, and the mean voltage of the last 10 s below 40 mV, five
    deviations of what the sensor noise below 0.05 Hz makes of it (8 mV). F and D have a zero at s = 0, K_p passes the
    bias, so its part is taken off by hand. (With the bias left in the error of the adaptation it was 0.19 V.)
    """
    model, plant = make_isolator(RATE), make_isolator(RATE, wn=140.0, zeta=0.7)
    p = settings(sample_rate=RATE, adapted_gains=gains, adapt_in_control=True)
    loop = make_loop(p, plant, paper_plan(RATE, (0.0, 0.1, 0.2, 0.3, 0.5), 1e4), identified=model)
    count = int(seconds * RATE)
    t = np.arange(count) / RATE
    noise = 0.05 * np.random.default_rng(9).standard_normal(count)
    d = np.sin(2 * np.pi * 10.0 * t) + noise + np.where(t > 0.3, 1.0, 0.0)
    last = slice(-int(10 * RATE), None)
    ys, us, offsets = [], [], []
    for k in range(count):
        y, out = loop.step(d[k])
        ys.append(float(y))
        us.append(float(out.voltage))
        offsets.append(-float(out.state.kp))  # of a bias of 1 m/s^2
    y, u, offset = np.array(ys), np.array(us), np.array(offsets)
    assert abs(np.mean((u - offset)[last])) < 0.04
    assert y[last].std() < 0.8
    state = loop.core.law.state
    assert 0.0 <= float(state.ki) <= float(state.ki_max)
    assert not loop.core._last.fault
