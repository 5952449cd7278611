# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from satvib_common.phases import Phase, PhasePlan
from satvib_common.signals.integrator import leaky_integrator
from satvib_control.laws.base import BasicLaw
from satvib_control.laws.narrowband.memory import Point
from satvib_control.laws.reasons import reason, text_of
from satvib_control.laws.registry import make_law
from satvib_control.model_analysis.gain_bounds import gain_bounds
from satvib_control.model_analysis.transfer import model_polynomials
from scipy.signal import freqz, lfilter

RATE = 200.0
PLAN = PhasePlan((Phase.STANDBY, Phase.IDENTIFY, Phase.CONTROL), (0, 1, 2), 10**6)
TIRED = reason('a reason of a test')


class Canceller(BasicLaw):
    """Cancels a tone of 12 Hz, by the gradient through the model's response at that frequency."""

    cancels = True
    needs_model = True
    rate = 2.0

    def __init__(self, parameters, dt, shape=()):
        super().__init__(parameters, dt, shape)
        self.weights = np.zeros(2)
        self.path = 0.0
        self.inputs = []

    def set_model(self, model, trusted, covariance=None):  # noqa: ARG002
        self.path = complex(model.frequency_response(12.0))

    def step(self, x, phase):
        self.inputs.append(x)
        w = 2.0 * np.pi * 12.0 * self.dt * x.sequence
        turned = self.path * np.exp(1j * w)
        gradient = np.array([turned.real, turned.imag])
        if phase == Phase.CONTROL and self.path != 0.0 and not x.saturated:
            self.weights -= self.rate * self.dt * float(x.upper) * gradient / abs(self.path) ** 2
        self.state.weight_norm = np.full(self.shape, np.hypot(*self.weights))
        return np.full(self.shape, self.weights @ [np.cos(w), np.sin(w)])


def summed(make_loop, settings, model, gain=150.0, cancel=True, **changes):
    """velocity_feedback and the canceller of this file, in a loop."""
    p = settings(
        **({'sample_rate': RATE, 'law': 'velocity_feedback', 'velocity_gain': gain} | changes)
    )
    loop = make_loop(p, model, PLAN)
    law = make_law('velocity_feedback+off', p, loop.core.dt)
    if cancel:
        law.parts[1] = Canceller(p, loop.core.dt)
    loop.core.law = law
    return loop


def test_the_feedback_does_not_move_the_cancellers_plant(make_isolator, make_loop, settings):
    """Truth: with an exact model the canceller's voltage is what it would be alone (1e-8), at any gain of the feedback,
    and the vibration is S times that of the canceller alone, S by SciPy from the loop's polynomials (1e-6)."""
    model = make_isolator(RATE)
    t = np.arange(int(8 * RATE)) / RATE
    d = np.sin(2 * np.pi * 12.0 * t) + 0.1 * np.random.default_rng(1).standard_normal(len(t))
    runs = {}
    for gain in (0.0, 150.0):
        loop = summed(make_loop, settings, model, gain, switch_on_time=0.0, watch_loudness=1000.0)
        ys, us = [], []
        for k in range(len(t)):
            y, _ = loop.step(d[k])
            ys.append(float(y))
            us.append(float(loop.core.law._demands[1]))
        runs[gain] = np.array(ys), np.array(us)
    np.testing.assert_allclose(runs[150.0][1], runs[0.0][1], atol=1e-8)
    b, a = model_polynomials(model)
    fb, fa = leaky_integrator(0.5, model.dt)
    base = np.convolve(a, fa)
    # the feedback acts from the first sample of CONTROL on, with an integrator that was warm
    closed = base + 150.0 * np.convolve(b, fb)
    truth = lfilter(base, closed, runs[0.0][0])
    late = t > 2.0
    np.testing.assert_allclose(runs[150.0][0][late], truth[late], atol=1e-3 * np.max(np.abs(truth)))
    assert runs[150.0][0][late].std() < 0.5 * d.std()


def test_a_gain_that_jumps_does_not_disturb_the_adaptation(make_isolator, make_loop, settings):
    """The feedback switched from nothing to its bound while the canceller adapts. Truth: the weights of a run without
    feedback, 1e-8; so neither can make the other unstable."""
    model = make_isolator(RATE)
    t = np.arange(int(6 * RATE)) / RATE
    d = np.sin(2 * np.pi * 12.0 * t)
    weights = []
    for jump in (False, True):
        gain = 1e6 if jump else 0.0
        loop = summed(make_loop, settings, model, gain, switch_on_time=0.0, watch_loudness=1000.0)
        feedback = loop.core.law.parts[0]
        for k in range(len(t)):
            if jump and k > 2:
                feedback._gain = np.array(0.0 if (k // 100) % 2 else float(feedback.state.ki))
            loop.step(d[k])
        weights.append(loop.core.law.parts[1].weights.copy())
    np.testing.assert_allclose(weights[1], weights[0], atol=1e-8)
    assert np.hypot(*weights[0]) > 1.0


def test_what_the_guard_takes_is_taken_from_the_cancellers(make_isolator, make_loop, settings):
    """Truth: the shares add up to the voltage that was applied, and the feedback keeps all of its own."""
    model = make_isolator(RATE)
    loop = summed(
        make_loop,
        settings,
        model,
        50.0,
        voltage_limit=1.0,
        excitation_amplitude=1.0,
        switch_on_time=0.0,
        watch_loudness=1000.0,
    )
    t = np.arange(400) / RATE
    canceller, feedback = loop.core.law.parts[1], loop.core.law.parts[0]
    cut = 0
    last = None
    for k in range(400):
        _, out = loop.step(2.0 * np.sin(2 * np.pi * 12.0 * t[k]))
        if last is not None and k > 3:
            assert float(canceller.inputs[-1].applied) == pytest.approx(
                last[0] - last[1], abs=1e-12
            )
            assert bool(canceller.inputs[-1].saturated) == last[2]
        last = (float(out.voltage), float(loop.core.law._demands[0]), bool(out.saturated))
        cut += last[2]
    assert cut > 50
    assert feedback.state.ki == 50.0


def test_feedback_and_tone_feedback_share_the_amplification(make_isolator, settings):
    """Truth: the bound for a margin of the square root of 0.5; and for 0.5 beside feedforward, which closes no loop."""
    model = make_isolator(RATE)
    p = settings(sample_rate=RATE, law='velocity_feedback', velocity_gain=1e6)
    fb, fa = leaky_integrator(p.velocity_corner, model.dt)
    for other, margin in (('off', 0.5**0.5), ('feedforward', 0.5)):
        law = make_law(f'velocity_feedback+{other}', p, model.dt)
        law.set_model(model, np.array(True))
        assert law.parts[0].state.ki_max == gain_bounds(model, fb, fa, margin).maximum


def test_the_state_shows_all_parts(make_isolator, make_loop, settings):
    loop = summed(make_loop, settings, make_isolator(RATE), 50.0)
    loop.run(20, np.ones(20))
    state = loop.core.law.state
    assert state.ki == 50.0
    assert np.isfinite(state.weight_norm)
    assert state.reason == 0
    loop.core.law.parts[1].state.reason = np.array(TIRED)
    loop.core.law._show()
    assert text_of(loop.core.law.state.reason) == 'a reason of a test'


def summed_law(make_isolator, settings, law):
    """A sum that has the model of the isolator, and that model."""
    model = make_isolator(RATE)
    p = settings(sample_rate=RATE, law=law, velocity_gain=150.0, modulus_margin=0.5)
    law = make_law(law, p, 1.0 / RATE)
    law.set_model(model, np.asarray(True))
    return law, model


def test_narrowband_keeps_the_margin_of_all_loops_together(make_isolator, settings):
    """Truth: |S_f| = 1 / |1 + G C| by scipy.signal.freqz, 1 where it is below 1; 1e-9. It has the whole margin."""
    law, model = summed_law(make_isolator, settings, 'velocity_feedback+narrowband')
    feedback, narrowband = law.parts
    omega = narrowband._points[..., Point.OMEGA]
    h = freqz(*leaky_integrator(feedback.parameters.velocity_corner, 1.0 / RATE), omega)[1]
    b, a = model_polynomials(model)
    loop = freqz(b, a, omega)[1] * float(feedback.state.ki) * h
    want = np.maximum(1.0 / np.abs(1.0 + loop), 1.0)
    assert want.max() > 1.05
    np.testing.assert_allclose(narrowband._points[..., Point.PARTNERS], want, rtol=1e-9)
    assert narrowband.parameters.modulus_margin == 0.5
    assert feedback.parameters.modulus_margin == pytest.approx(0.5**0.5)


def test_narrowband_beside_a_loop_that_adapts_has_its_root_of_the_margin(make_isolator, settings):
    """Truth: the gains of model_reference change, so its |S| is not known: each loop has the square root, as before."""
    law, _ = summed_law(make_isolator, settings, 'model_reference+narrowband')
    assert law.parts[1].parameters.modulus_margin == pytest.approx(0.5**0.5)
    assert np.all(law.parts[1]._points[..., Point.PARTNERS] == 1.0)
