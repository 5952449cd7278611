# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Law narrowband on the paper's strut: what it reaches, what it stands, when it stays at 0 V."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_control.laws.base import LawInput
from satvib_control.laws.reasons import text_of
from satvib_control.laws.registry import make_law
from satvib_ident.models.iir_model import IirModel

NOISE = 0.098  # m/s^2: 10 mg, the paper's accelerometer


def plan_of(rate, control=4.0, end=20.0):
    """Listen, then act; an IDENTIFY of one sample, for models are handed over only after one."""
    steps = [(Phase.STANDBY, 0.0), (Phase.IDENTIFY, control - 1.0 / rate), (Phase.CONTROL, control)]
    return PhasePlan.from_seconds(steps, end, rate)


def sines(rate, end, *frequencies, amplitude=1.0):
    t = np.arange(round(end * rate)) / rate
    return sum(amplitude * np.sin(2.0 * np.pi * f * t + f) for f in frequencies)


def noisy(d, seed, trials=None):
    rng = np.random.default_rng([seed, len(d)])
    shape = d.shape if trials is None else (len(d), trials)
    return (d if trials is None else d[:, None]) + NOISE * rng.standard_normal(shape)


def tone_level(y, f, rate, begin):
    """Amplitude at f in dB of 1 m/s^2, by least squares, (trials)."""
    t = np.arange(len(y))[round(begin * rate) :] / rate
    x = np.column_stack([np.cos(2 * np.pi * f * t), np.sin(2 * np.pi * f * t), np.ones(len(t))])
    c = np.linalg.lstsq(x, y[round(begin * rate) :], rcond=None)[0]
    return 20.0 * np.log10(np.hypot(c[0], c[1]))


def identify(plant, rate, seed):
    """The paper's five parameters by least squares from 2 s of its squares at 10 V, with the sensor's noise."""
    n = round(2.0 * rate)
    t = np.arange(n) / rate
    u = 10.0 * np.sign(np.sin(2 * np.pi * t) + 0.5 * np.sin(4 * np.pi * t) + 1e-9)
    y = noisy(plant.simulate(u), seed)
    past = [-y[4 - i : n - i] for i in (1, 2)] + [u[4 - i : n - i] for i in (1, 2, 3)]
    theta = np.linalg.lstsq(np.column_stack(past), y[4:], rcond=None)[0]
    return IirModel(theta[:2], theta[2:], 1, 1.0 / rate)


def late(model, f, degrees):
    """The model behind a first-order all-pass that lags by `degrees` at f and turns no gain."""
    w = 2.0 * np.pi * f * model.dt
    low, high = -0.9999, 0.9999
    for _ in range(60):  # the lag falls with c
        c = 0.5 * (low + high)
        z = np.exp(-1j * w)
        lag = -np.degrees(np.angle((c + z) / (1.0 + c * z)))
        low, high = (c, high) if lag > degrees else (low, c)
    a = np.convolve(np.r_[1.0, model.a], [1.0, c])[1:]
    return IirModel(a, np.convolve(model.b, [c, 1.0]), model.delay, model.dt)


@pytest.mark.parametrize(
    ('rate', 'f'), [(100.0, 10.0), (100.0, 20.0), (200.0, 10.0), (200.0, 20.0)]
)
def test_the_papers_strut_identified_from_noisy_data(make_isolator, make_loop, settings, rate, f):
    """Truth: the tone put in, as the loop measures it: wanted beyond -30 dB; and the noise, within 1.5 dB."""
    plant = make_isolator(rate)
    models = [identify(plant, rate, seed) for seed in range(3)]
    batch = IirModel([m.a for m in models], [m.b for m in models], 1, 1.0 / rate)
    loop = make_loop(
        settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0),
        plant,
        plan_of(rate),
        (3,),
        batch,
    )
    y, u = loop.run(round(20 * rate), noisy(sines(rate, 20.0, f), 1, 3))
    assert tone_level(y, f, rate, 8.0).max() < -45.0
    assert y[round(8 * rate) :].std(axis=0).max() < 1.19 * NOISE
    # bumpless: the tone is known before the first sample of CONTROL, so the vibration never grows
    before = np.abs(y[: round(4 * rate)]).max()
    assert np.abs(y[round(4 * rate) :]).max() < before + 2.0 * NOISE
    assert np.abs(u[: round(4 * rate)]).max() == 0.0
    assert loop.core.law.state.frequency == pytest.approx(f, abs=0.02)


@pytest.mark.parametrize(
    ('rate', 'f'), [(100.0, 10.0), (100.0, 20.0), (200.0, 10.0), (200.0, 20.0)]
)
@pytest.mark.parametrize('which', ['plant', 'model'])
def test_stands_a_phase_error_of_50_degrees(make_isolator, make_loop, settings, rate, f, which):
    """Truth: the claim. Either the plant or the model lags by 50 degrees at the tone; no pause, and the same end."""
    true = make_isolator(rate)
    wrong = late(true, f, 50.0)
    plant, model = (wrong, true) if which == 'plant' else (true, wrong)
    loop = make_loop(
        settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0),
        plant,
        plan_of(rate),
        (),
        model,
    )
    y, _ = loop.run(round(20 * rate), noisy(sines(rate, 20.0, f), 2))
    assert tone_level(y, f, rate, 12.0) < -40.0
    assert np.abs(y).max() < 1.0 + 5.0 * NOISE


@pytest.mark.parametrize('degrees', [66.0, 70.0, 75.0, 80.0, 90.0, 105.0, 120.0, 150.0, 178.0])
def test_a_model_of_the_wrong_sign_is_corrected(make_isolator, make_loop, settings, degrees):
    """Truth: the tone put in, 0 dB. The first attempt makes it louder and is taken back, for one pause of a second.

    It has shown how the plant answers at the tone; the next attempt cancels (-67 dB in the worst of three seeds).
    """
    rate, f = 200.0, 20.0
    true = make_isolator(rate)
    loop = make_loop(
        settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0),
        late(true, f, degrees),
        plan_of(rate, end=20.0),
        (),
        true,
    )
    y, u = loop.run(4000, noisy(sines(rate, 20.0, f), 3))
    assert np.abs(y).max() < 4.0
    assert tone_level(y, f, rate, 12.0) < -40.0
    paused = np.flatnonzero(u[820:] == 0.0)
    assert 180 < len(paused) < 240
    assert len(paused) == paused[-1] - paused[0] + 1
    assert text_of(int(loop.core.law.state.reason)).startswith('the model is corrected')


def test_a_voltage_that_never_arrives_is_taken_back(make_isolator, make_loop, settings):
    """A coil that is open, or a board that has latched 0 V without telling. Truth: y = d whatever the voltage."""
    rate, f = 200.0, 20.0
    model = make_isolator(rate)
    dead = IirModel(model.a, 0.0 * model.b, model.delay, model.dt)
    p = settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0)
    loop = make_loop(p, dead, plan_of(rate, end=40.0), (), model)
    _, u = loop.run(8000, noisy(sines(rate, 40.0, f), 3))
    assert (u[4000:] == 0.0).mean() > 0.5


def test_bits_do_not_depend_on_the_batch(make_isolator, make_loop, settings):
    """Truth: the same strut alone. Exact."""
    rate = 100.0
    plant = make_isolator(rate)
    d = noisy(sines(rate, 8.0, 10.0, 23.0), 4, 6).reshape(800, 2, 3)
    p = settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0)
    together = make_loop(p, plant, plan_of(rate, 3.0, 8.0), (2, 3), plant).run(800, d)[1]
    assert np.abs(together).max() > 1.0
    for trial, strut in [(0, 0), (1, 2)]:
        alone = make_loop(p, plant, plan_of(rate, 3.0, 8.0), (), plant).run(800, d[:, trial, strut])
        np.testing.assert_array_equal(alone[1], together[:, trial, strut])


def test_three_tones_that_change(make_isolator, make_loop, settings):
    """Truth: what was put in: three tones, then one of them jumps, then one stops; the noise is what remains."""
    rate = 200.0
    plant = make_isolator(rate)
    t = np.arange(6000) / rate
    f = np.where(t < 15.0, 10.0, 12.0)
    d = np.sin(2 * np.pi * np.cumsum(f) / rate) + sines(rate, 30.0, 18.0, 31.0, amplitude=0.5)
    d = d - np.where(t > 22.0, sines(rate, 30.0, 18.0, amplitude=0.5), 0.0)
    loop = make_loop(
        settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0),
        plant,
        plan_of(rate, 3.0, 30.0),
        (),
        plant,
    )
    y, _ = loop.run(6000, noisy(d, 5))
    for begin, end in ((8, 15), (18, 22), (26, 30)):
        assert y[begin * 200 : end * 200].std() < 1.25 * NOISE
    found = np.sort(loop.core.law.tones()[0])
    np.testing.assert_allclose(found[:2], [12.0, 31.0], atol=0.05)
    assert np.isnan(found[2])


def test_voltage_limit_is_shared_and_nothing_winds_up(make_isolator, make_loop, settings):
    """Truth: the limit; and the same loop without a limit, to which the voltage returns when the tone gets weaker."""
    rate, f = 200.0, 10.0
    plant = make_isolator(rate)
    t = np.arange(4000) / rate
    d = np.where(t < 10.0, 3.0, 0.5) * np.sin(2 * np.pi * f * t)
    p = settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0, voltage_limit=5.0)
    loop = make_loop(p, plant, plan_of(rate, 3.0), (), plant)
    ys, us, why = [], [], set()
    for value in noisy(d, 6):
        y, out = loop.step(value)
        ys.append(float(y))
        us.append(float(out.voltage))
        why.add(out.reason_text())
    y, u = np.array(ys), np.array(us)
    assert np.abs(u).max() <= 5.0
    assert 'the voltage limit does not cancel all of the tones' in why
    # the limited voltage still takes away what it can: |G| 5 V of the 3 m/s^2
    gain = abs(plant.frequency_response(f))
    wanted = 20.0 * np.log10(3.0 - 5.0 * float(gain))
    assert tone_level(y[:2000], f, rate, 6.0) == pytest.approx(wanted, abs=0.5)
    assert y[2400:].std() < 1.2 * NOISE


def test_nothing_to_reject_is_0_volts(make_isolator, make_loop, settings):
    """Truth: no tone was put in; a false find may cost some samples in a hundred, and says so by its state."""
    rate = 200.0
    plant = make_isolator(rate)
    loop = make_loop(
        settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0),
        plant,
        plan_of(rate, 2.0, 40.0),
        (4,),
        plant,
    )
    y, u = loop.run(8000, noisy(np.zeros(8000), 7, 4))
    assert (u == 0.0).mean() > 0.98
    assert y.std() < 1.01 * NOISE
    reasons = {text_of(code) for code in loop.core.law.state.reason}
    assert 'no tone stands out of the noise: 0 V' in reasons


def test_without_a_model_0_volts(make_isolator, make_loop, settings):
    """Truth: the law's own rule; the reason says why."""
    rate = 100.0
    plant = make_isolator(rate)
    p = settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0)
    never = PhasePlan.from_seconds([(Phase.STANDBY, 0.0), (Phase.CONTROL, 1.0)], 4.0, rate)
    for plan, trusted in ((never, True), (plan_of(rate, 1.0, 4.0), False)):
        loop = make_loop(p, plant, plan, (), plant, trusted)
        _, u = loop.run(400, sines(rate, 4.0, 10.0))
        assert np.abs(u).max() == 0.0
        assert text_of(loop.core.law.state.reason) == 'no trusted identified model: 0 V'


def test_lost_samples_do_not_disturb_the_tone(make_isolator, make_loop, settings):
    """Truth: a missing sample is 0 V by the core's rule; five in a row leave the tone cancelled soon after."""
    rate, f = 200.0, 20.0
    plant = make_isolator(rate)
    d = noisy(sines(rate, 10.0, f), 8)
    d[1400:1405] = np.nan
    loop = make_loop(
        settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0),
        plant,
        plan_of(rate, 3.0, 10.0),
        (),
        plant,
    )
    y, u = loop.run(2000, d)
    assert np.isfinite(u).all()
    assert np.abs(u[1400:1405]).max() == 0.0
    assert y[1450:].std() < 1.25 * NOISE


def test_a_new_model_in_the_middle_is_taken_without_a_bump(make_isolator, settings):
    """Truth: the same run without the new model; the tone stays cancelled, by 30 dB at least at every moment."""
    rate, f = 200.0, 20.0
    plant, other = make_isolator(rate), make_isolator(rate, wn=140.0, zeta=0.7)
    law = make_law(
        'narrowband',
        settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0),
        1.0 / rate,
    )
    yes, no = np.asarray(True), np.asarray(False)
    from satvib_common.signals.iir_filter import IirFilter
    from satvib_control.model_analysis.transfer import model_polynomials

    actuator = IirFilter(*model_polynomials(plant))
    d, u, ys = sines(rate, 12.0, f), np.asarray(0.0), []
    for k in range(2400):
        y = actuator.state[0] + d[k]
        if k == 600:
            law.set_model(plant, yes)
        if k in {1500, 1800}:
            law.set_model(other, yes)
        phase = Phase.CONTROL if k >= 600 else Phase.STANDBY
        u = law.step(LawInput(k, np.asarray(y), np.asarray(np.nan), u, no, yes), phase)
        actuator.step(u)
        ys.append(float(y))
    y = np.abs(ys)
    assert y[1000:1500].max() < 0.01
    assert y[1500:].max() < 0.35
    assert y[2000:].max() < 0.01


def test_in_a_sum_with_velocity_feedback(make_isolator, make_loop, settings):
    """Truth: the tone put in is gone, with the feedback in the loop or not, and the noise is not amplified."""
    rate, f = 200.0, 12.0
    plant = make_isolator(rate, zeta=0.05, wn=60.0)
    d = noisy(sines(rate, 16.0, f), 9)
    p = settings(sample_rate=rate, law='velocity_feedback+narrowband', velocity_gain=5.0)
    loop = make_loop(p, plant, plan_of(rate, 4.0, 16.0), (), plant)
    y, _ = loop.run(3200, d)
    assert tone_level(y, f, rate, 9.0) < -40.0


def test_reset_forgets_the_tones(make_isolator, make_loop, settings):
    """Truth: after a reset nothing is tracked, the model stays, and the tone is found again."""
    rate = 200.0
    plant = make_isolator(rate)
    loop = make_loop(
        settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0),
        plant,
        plan_of(rate, 2.0, 12.0),
        (),
        plant,
    )
    d = noisy(sines(rate, 12.0, 10.0), 10)
    loop.run(1200, d)
    loop.core.reset()
    assert np.isnan(loop.core.law.tones()[0]).all()
    y, _ = loop.run(1200, d[1200:])
    assert y[600:].std() < 1.25 * NOISE


@pytest.mark.parametrize(('low', 'high'), [(20.0, 10.0), (10.0, 60.0), (60.0, 0.0)])
def test_a_band_that_is_none_is_refused(settings, low, high):
    """Truth: the band must lie below half the sample rate; the message names the settings."""
    with pytest.raises(SatvibError, match='narrowband_low'):
        settings(
            sample_rate=100.0, law='narrowband', excitation_amplitude=0.0, narrowband_low=low, narrowband_high=high
        )  # fmt: skip


def drift(make_isolator, make_loop, settings, seconds):
    """10 Hz and 20 Hz in turn, 20 s each: mean voltage and noise of the last stretch beside an early one."""
    rate = 100.0
    plant = make_isolator(rate)
    t = np.arange(round(seconds * rate)) / rate
    f = np.where((t // 20.0) % 2 == 0, 10.0, 20.0)
    loop = make_loop(
        settings(sample_rate=rate, law='narrowband', excitation_amplitude=0.0),
        plant,
        plan_of(rate, 4.0, seconds),
        (),
        plant,
    )
    y, u = loop.run(len(t), noisy(np.sin(2 * np.pi * np.cumsum(f) / rate), 11))
    last = slice(len(t) - round(14 * rate), len(t))
    first = slice(round(26 * rate), round(40 * rate))
    assert abs(u[last].mean()) < 0.02
    assert y[last].std() < 1.1 * y[first].std()
    assert y[last].std() < 1.3 * NOISE


def test_no_drift(make_isolator, make_loop, settings):
    """Truth: a tone asks for no mean voltage; the short form, two minutes."""
    drift(make_isolator, make_loop, settings, 120.0)


@pytest.mark.long
def test_no_drift_in_ten_minutes(make_isolator, make_loop, settings):
    """Truth: a tone asks for no mean voltage."""
    drift(make_isolator, make_loop, settings, 600.0)
