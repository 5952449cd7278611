# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The feedforward law on paths whose optimum is known: y = d + G u, x_m = x + F u, a guard at 20 V."""

import math

import numpy as np
import pytest
from satvib_common.phases import Phase
from satvib_common.signals.iir_filter import IirFilter
from satvib_control.laws.base import LawInput
from satvib_control.laws.feedforward.law import GAVE_UP
from satvib_control.laws.feedforward.wiener import wiener_optimum
from satvib_control.laws.reasons import text_of
from satvib_control.laws.registry import law_class, make_law
from satvib_ident.models.iir_model import IirModel
from scipy.signal import lfilter

RATE = 200.0
PATH = IirModel([-0.7, 0.3], [0.6, -0.2], 1, 1 / RATE)


class World:
    """A strut with a law and nothing else, for any batch."""

    def __init__(self, settings, path=PATH, model=None, shape=(), reaction=(0.0,), **changes):
        p = settings(**({'sample_rate': RATE, 'law': 'feedforward'} | changes))
        self.law = make_law(p.law, p, 1 / RATE, shape)
        self.shape, self.limit, self.k = shape, p.voltage_limit, 0
        length = max(len(np.atleast_1d(path.a)), path.delay + path.b.shape[-1]) + 1
        b, a = np.zeros((2, length))
        b[path.delay : path.delay + path.b.shape[-1]], a[0] = path.b, 1.0
        a[1 : 1 + path.order] = path.a
        self.plant = IirFilter(b, a, shape)
        self.back = IirFilter([0.0, *reaction], [1.0] + [0.0] * len(reaction), shape)
        self.applied, self.cut = np.zeros(shape), np.zeros(shape, dtype=bool)
        model = path if model is None else model
        if model is not False:
            self.law.set_model(model, np.ones(shape, dtype=bool))

    def sample(self, x, d, phase=Phase.CONTROL, excite=0.0, hidden=False):
        """One sample; gives y and the voltage."""
        y = self.plant.state[..., 0] + d
        lower = self.back.state[..., 0] + x
        lower = np.where(hidden, np.nan, lower)
        valid = np.ones(self.shape, dtype=bool)
        seen = LawInput(self.k, y, lower, self.applied, self.cut, valid, 1.0)
        u = self.law.step(seen, phase)
        if phase == Phase.IDENTIFY:
            u = np.full(self.shape, excite)
        self.applied = np.clip(u, -self.limit, self.limit)
        self.cut = self.applied != u
        self.plant.step(self.applied)
        self.back.step(self.applied)
        self.k += 1
        return y, self.applied

    def run(self, x, d, **options):
        found = [self.sample(x[i], d[i], **options) for i in range(len(x))]
        return np.array([y for y, _ in found]), np.array([u for _, u in found])

    def reason(self, index=()):
        return text_of(self.law.state.reason[index])


def coloured(count, seed=1):
    """Random vibration of 1 m/s^2 RMS and what of it passes to the payload, two samples later."""
    x = lfilter([1.0], [1.0, -1.2, 0.5], np.random.default_rng(seed).standard_normal(count))
    x = x / x.std()
    return x, np.concatenate([np.zeros(2), lfilter([0.8, 0.3], [1.0, -0.6], x)[:-2]])


def tone(count, frequency=10.0, amplitude=1.0, phase=0.7):
    w = 2 * np.pi * frequency / RATE * np.arange(count)
    return amplitude * np.sin(w), 1.2 * amplitude * np.sin(w - phase)


def decibel(after, before):
    return 20 * math.log10(np.sqrt((after**2).mean()) / np.sqrt((before**2).mean()))


def test_it_is_found_by_name():
    """Truth: the class of this package; it needs a model, and gets the plant without the feedback of other laws."""
    law = law_class('feedforward')
    assert law.__module__ == 'satvib_control.laws.feedforward.law'
    assert law.needs_model
    assert law.cancels


@pytest.mark.parametrize(('method', 'within'), [('fxrls', 0.3), ('fxlms', 2.0)])
def test_random_vibration_ends_near_the_causal_wiener_optimum(settings, method, within):
    """Truth: least squares over the record, found on its first half, judged on its second, with the same leak.

    The misadjustment of least squares is p / (2 memory rate), 0.01 dB; LMS has its gradient noise and its slow modes.
    """
    x, d = coloured(10_000)
    world, y = random_world(settings, method, x, d)
    best = wiener_optimum(x, d, PATH, 8, False, leak=1e-4)
    assert best.attenuation < -20.0
    assert decibel(y[5000:], d[5000:]) == pytest.approx(best.attenuation, abs=within)
    if method == 'fxrls':
        spread = np.abs(world.law.weights - best.weights) / np.abs(best.weights).max()
        assert spread.max() < 0.05


def test_poles_of_its_own_pass_the_optimum_of_a_filter_without(settings):
    """Here W = -P / G is recursive.

    Truth: 8 taps and 2 poles leave 20 dB less than the best 8 taps.
    """
    x, d = coloured(10_000)
    y = random_world(settings, 'filtered_u', x, d)[1]
    best = wiener_optimum(x, d, PATH, 8, False).attenuation
    assert decibel(y[5000:], d[5000:]) < best - 20.0


def random_world(settings, method, x, d):
    """A world that has lived through x and d, and its y."""
    world = World(
        settings, feedforward_method=method, feedforward_taps=8, feedforward_motion=False,
        feedforward_memory=10.0, feedforward_leak=1e-4, feedforward_step=0.02,
    )  # fmt: skip
    return world, world.run(x, d)[0]


@pytest.mark.parametrize('method', ['fxrls', 'filtered_u', 'fxlms'])
def test_a_tone_goes_down_to_the_leak(settings, method):
    """Truth, closed form: each of the two directions has half of the power P of 16 taps: the leak leaves
    q (P / 16) / (P / 2) of the disturbance for least squares, 2 q for LMS; 3 dB and 1 dB for the estimate. -30 dB after
    3 s.
    """
    x, d = tone(2000)
    world = World(settings, feedforward_method=method, feedforward_motion=False)
    y, u = world.run(x, d)
    bound = 20 * math.log10(2e-3) + 1.0 if method == 'fxlms' else 20 * math.log10(2e-3 / 16) + 3.0
    assert decibel(y[-400:], d[-400:]) < bound
    assert decibel(y[600:800], d[600:800]) < -30.0
    assert np.abs(u).max() < 1.2 * np.abs(u[-400:]).max() + 0.5


@pytest.mark.parametrize('method', ['fxrls', 'fxlms'])
def test_a_phase_error_below_90_degrees_still_converges(settings, method):
    """Truth, closed form: the weights move by Re(G / G_hat) > 0 (Morgan 1980); -30 dB after 30 s, with G_hat a FIR
    filter that is G turned by -80, -40, 40 and 80 degrees at 10 Hz.
    """
    x, d = tone(6000)
    world = World(
        settings, model=turned([-80, -40, 40, 80]), shape=(4,), feedforward_method=method,
        feedforward_motion=False, feedforward_memory=0.5,
    )  # fmt: skip
    y, u = world.run(x, d)
    for i in range(4):
        assert decibel(y[-400:, i], d[-400:]) < -30.0
    assert np.abs(u).max() < 20.0


@pytest.mark.parametrize('method', ['fxrls', 'fxlms'])
def test_beyond_90_degrees_it_backs_off_and_gives_up(settings, method):
    """Truth, closed form: it cannot converge there. The voltage never reaches the rail, and the state says why. The
    payload moves R = 3 times as much as without control before the alarm; twice that with what is under way then. What
    is tried later ends at an alarm that needs R^(1/3) = 1.44; 1.6 with what is under way.
    """
    x, d = tone(6000)
    world = World(
        settings, model=turned([120, 180, -120]), shape=(3,), feedforward_method=method,
        feedforward_motion=False, feedforward_memory=0.5,
    )  # fmt: skip
    given_up = np.zeros((len(x), 3), dtype=bool)
    y, u = np.zeros((2, len(x), 3))
    for k in range(0, len(x), 20):
        part = slice(k, k + 20)
        y[part], u[part] = world.run(x[part], d[part])
        given_up[part] = [world.reason(i) == text_of(GAVE_UP) for i in range(3)]
    assert np.abs(u).max() < 10.0
    assert np.abs(y).max() < 6.0 * np.abs(d).max()
    assert np.all(given_up[-4000:].mean(axis=0) > 0.5)
    assert np.abs(y[-4000:]).max() < 1.6 * np.abs(d).max()
    # another model is another chance
    world.law.set_model(PATH, np.ones(3, dtype=bool))
    y, _ = world.run(x[:1600], d[:1600])
    for i in range(3):
        assert decibel(y[-400:, i], d[:400]) < -30.0


@pytest.mark.parametrize('method', ['fxrls', 'fxlms'])
def test_a_shock_is_not_learnt_from(settings, method):
    """A half-sine of 20 ms and 20 m/s^2 on a tone that is cancelled.

    Truth: the same run without the shock. Two seconds after it, when the integrals have forgotten it (0.5 Hz: e^-6),
    the weights leave as much of the tone as there, within 1 dB and 1 % of the disturbance. The voltage stays below
    20 V.
    """
    x, d = tone(2400)
    shock = np.zeros(2400)
    shock[1200:1204] = 20.0 * np.sin(np.pi * (np.arange(4) + 0.5) / 4)
    shaken = d + lfilter([0.8, 0.3], [1.0, -0.6], np.concatenate([np.zeros(2), shock[:-2]]))
    worlds = [World(settings, feedforward_method=method) for _ in range(2)]
    calm, _ = worlds[0].run(x, d)
    y, u = worlds[1].run(x + shock, shaken)
    after = slice(1200 + int(2.0 * RATE), 1200 + int(3.0 * RATE))
    assert np.sqrt((y[after] ** 2).mean()) < 1.12 * np.sqrt((calm[after] ** 2).mean()) + 0.01
    assert np.abs(u).max() < 20.0


def turned(degrees, frequency=10.0):
    """Models with two taps whose response at a frequency is that of PATH turned by an angle, one per angle."""
    z = np.exp(-2j * np.pi * frequency / RATE)
    wanted = PATH.frequency_response(frequency) * np.exp(1j * np.radians(degrees)) / z
    second = wanted.imag / z.imag
    b = np.stack([wanted.real - second * z.real, second], axis=-1)
    return IirModel(np.zeros((len(b), 0)), b, 1, 1 / RATE)


def test_without_a_model_or_a_reference_it_is_0_v_by_name(settings):
    """Truth: 0 V exactly, with the reason."""
    x, d = tone(600)
    world = World(settings, model=False)
    assert not world.run(x, d)[1].any()
    assert world.reason() == 'no trusted identified model: 0 V'
    world = World(settings)
    assert not world.run(x, d, hidden=True)[1].any()
    assert world.reason() == 'feedforward: the lower acceleration is missing: 0 V'
    assert not world.law.weights.any()


@pytest.mark.parametrize(('gap', 'back'), [(1, 16), (50, 16 + 191)])
def test_a_gap_in_the_reference_gives_0_v_until_the_history_is_complete(settings, gap, back):
    """Truth: 0 V in the gap and for the 16 taps after it, and for a long gap until the integrals have settled,
    3 / (2 pi 0.5 Hz) = 191 samples; then the voltage that there would have been, to 2 % of its amplitude.
    """
    x, d = tone(4000)
    whole, holed = World(settings), World(settings)
    for world in (whole, holed):
        world.run(x[:2000], d[:2000])
    weights = holed.law.weights.copy()
    voltages = []
    for k in range(2000, 2600):
        hidden = k < 2000 + gap
        voltages.append((whole.sample(x[k], d[k])[1], holed.sample(x[k], d[k], hidden=hidden)[1]))
        if hidden:
            assert holed.reason() == 'feedforward: the lower acceleration is missing: 0 V'
            assert np.array_equal(weights, holed.law.weights)
    there, here = np.array(voltages).T
    assert not here[: gap + back - 1].any()
    assert here[gap + back :].any()
    assert np.abs(here - there)[gap + back + 2 :].max() < 0.02 * np.abs(there).max()


def test_samples_that_never_came_are_a_gap_too(settings):
    """Truth: the tap line has a hole: 0 V until it has passed."""
    x, d = tone(1000)
    world = World(settings)
    world.run(x, d)
    world.k += 2
    assert world.sample(x[0], d[0])[1] == 0.0
    assert (
        world.reason() == 'feedforward: the history of the lower acceleration is not complete: 0 V'
    )


def test_a_demand_beyond_the_coil_comes_down_to_it(settings):
    """A tone that needs 32 V of 20 V.

    Truth: the weights shrink until it fits: less than 10 % of the samples are cut; the best that a sine of 20 V can do
    leaves 1 - 20 / need, and it must come within 15 % of d of that. With a third of the tone it recovers.
    """
    need = 32.0
    gain = abs(PATH.frequency_response(10.0))
    x, d = tone(4000, amplitude=need * gain / 1.2)
    world = World(settings)
    y, u = world.run(x, d)
    assert (np.abs(u[-2000:]) >= 20.0).mean() < 0.1
    left = np.sqrt((y[-2000:] ** 2).mean() / (d[-2000:] ** 2).mean())
    assert left < 1.0 - 20.0 / need + 0.15
    y, _ = world.run(x / 3.0, d / 3.0)
    assert decibel(y[-400:], d[-400:] / 3.0) < -40.0


def test_what_is_too_small_teaches_nothing(settings):
    """Truth: below the floor of 0.02 m/s^2 nothing moves, and the state says so."""
    x, d = tone(2000, amplitude=0.02)
    world = World(settings)
    world.run(x, d)
    assert not world.law.weights.any()
    assert not world.law.state.adapting


def test_a_new_model_does_not_move_the_voltage(settings):
    """Truth: the same loop without the hand-over; exact on the sample, and learning goes on with the new path."""
    x, d = tone(3000)
    ours, other = World(settings), World(settings)
    for world in (ours, other):
        world.run(x[:1500], d[:1500])
    ours.law.set_model(
        IirModel([-0.7, 0.3, 0.0, 0.0], [0.6, -0.21, 0.01], 1, 1 / RATE), np.array(True)
    )
    # the weights of this sample have learnt through the new model, by a hair
    now, before = ours.sample(x[1500], d[1500])[1], other.sample(x[1500], d[1500])[1]
    assert now == pytest.approx(before, abs=1e-3 * np.abs(x).max())
    y, _ = ours.run(x[1501:], d[1501:])
    assert decibel(y[-400:], d[-400:]) < -50.0


def test_a_model_handed_over_late_finds_its_filters_warm(settings):
    """The struts are shaken in IDENTIFY and control begins on the next sample.

    Truth: the voltage of IDENTIFY is known, so what it still does is no disturbance: with nothing from below nothing is
    learnt and nothing is asked for.
    """
    world = World(settings, model=False)
    rng = np.random.default_rng(3)
    for _ in range(800):
        world.sample(0.0, 0.0, phase=Phase.IDENTIFY, excite=rng.uniform(-10.0, 10.0))
    world.law.set_model(PATH, np.array(True))
    _, u = world.run(np.zeros(400), np.zeros(400))
    assert not u.any()
    assert np.abs(world.law.state.model_output).max() < 1e-9


def test_reset_forgets_the_weights_and_keeps_the_model(settings):
    """Truth: at rest as on the first day, and it learns again without a new model."""
    x, d = tone(2000)
    world = World(settings)
    world.run(x, d)
    world.law.reset()
    assert not world.law.weights.any()
    y, _ = world.run(x, d)
    assert decibel(y[-400:], d[-400:]) < -50.0


@pytest.mark.parametrize('method', ['fxrls', 'filtered_u', 'fxlms'])
def test_bits_do_not_depend_on_the_batch(settings, method):
    """A batch of 2 x 3 with IDENTIFY, gaps, saturation and a model of its own each. Truth: item by item. Exact."""
    rng = np.random.default_rng(4)
    shape, count = (2, 3), 500
    x, d = rng.standard_normal((2, count, *shape)) * [[[[1.0]]], [[[3.0]]]]
    hidden = rng.random((count, *shape)) < 0.01
    a, b = 0.2 * rng.standard_normal((*shape, 2)), rng.standard_normal((*shape, 3))
    options = {
        'feedforward_method': method, 'voltage_limit': 3.0, 'excitation_amplitude': 1.0,
        'watch_time': 0.1,
    }  # fmt: skip

    def drive(world, pick):
        out = []
        for k in range(count):
            phase = Phase.IDENTIFY if k < 150 else Phase.CONTROL
            volt = math.sin(k * k * 0.01)
            seen = (x[k][pick], d[k][pick])
            out.append(
                world.sample(*seen, phase=phase, excite=volt, hidden=hidden[k][pick])[1].copy()
            )
        return np.array(out), world.law.weights

    reaction = (-0.02, 0.05)
    model = IirModel(a, b, 1, 1 / RATE)
    together = World(settings, model=model, shape=shape, reaction=reaction, **options)
    voltages, weights = drive(together, ...)
    assert np.abs(voltages[150:]).max() == 3.0
    for i in np.ndindex(shape):
        alone = World(settings, model=model[i], reaction=reaction, **options)
        one, own = drive(alone, i)
        assert np.array_equal(one, voltages[(slice(None), *i)])
        assert np.array_equal(own, weights[i])


@pytest.mark.parametrize('method', ['fxrls', 'fxlms'])
def test_a_reference_that_hears_the_strut_needs_protection(settings, method):
    """The reaction is so strong that the loop through the lower sensor has a gain above 1 with the weights that cancel.

    Truth: the same world with and without the protection: without it the vibration is never reduced by 10 dB and the
    law backs off again and again; with it the tone goes down by 40 dB and no voltage is cut.
    """
    x, d = tone(4000)
    # W = 1.2 / |G| at the tone, so |W F| = 3 there and below
    peak = abs(PATH.frequency_response(10.0)) / 1.2 * 3.0
    reaction = (0.5 * peak, 0.5 * peak)
    found = {}
    for time in (0.0, 0.04):
        world = World(
            settings, reaction=reaction, feedforward_method=method, feedforward_struts=1,
            feedforward_protection_time=time,
        )  # fmt: skip
        rng = np.random.default_rng(5)
        for _ in range(400):
            world.sample(0.0, 0.0, phase=Phase.IDENTIFY, excite=rng.uniform(-2.0, 2.0))
        y, u = world.run(x, d)
        found[time] = decibel(y[-1000:], d[-1000:]), np.abs(u).max()
        if time:
            np.testing.assert_allclose(
                world.law.protection.reaction[:3], [*reaction, 0.0], atol=1e-3 * peak
            )
    assert found[0.0][0] > -10.0
    assert found[0.04][0] < -40.0
    assert found[0.04][1] < 20.0
