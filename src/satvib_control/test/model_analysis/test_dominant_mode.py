# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from satvib_common.signals.integrator import leaky_integrator
from satvib_control.model_analysis.dominant_mode import damping_gain, dominant_pole, polarity
from satvib_control.model_analysis.gain_bounds import gain_bounds
from satvib_control.model_analysis.transfer import model_polynomials, multiply
from satvib_ident.models.iir_model import IirModel

PLANTS = [(131.0, 0.79), (131.0, 0.3), (56.5, 0.05), (56.5, 0.005)]


@pytest.mark.parametrize('rate', [100.0, 200.0, 500.0, 1000.0])
@pytest.mark.parametrize('plant', PLANTS)
@pytest.mark.parametrize('latency', [0.0, 0.2, 0.9])
def test_the_polarity_is_that_of_the_wiring(make_isolator, rate, plant, latency):
    """Truth: the sign of the gain that the plant was made with."""
    for sign in (1.0, -1.0):
        model = make_isolator(rate, wn=plant[0], zeta=plant[1], gain=1.2 * sign, latency=latency)
        assert polarity(model, *leaky_integrator(0.5, 1.0 / rate)) == sign


@pytest.mark.parametrize('plant', PLANTS)
def test_the_dominant_pole_is_the_mode(make_isolator, plant):
    """Truth: the continuous pole that the plant was made with; exact under zero-order hold, 1e-6."""
    model = make_isolator(500.0, wn=plant[0], zeta=plant[1])
    s = complex(dominant_pole(model, *leaky_integrator(0.5, 0.002)))
    assert abs(s) == pytest.approx(plant[0], rel=1e-6)
    assert -s.real / abs(s) == pytest.approx(plant[1], rel=1e-6)


def test_the_effective_damping_is_the_poles_own_for_an_ideal_skyhook():
    """Truth: the closed-loop pole by numpy.roots, of a lightly damped mode sampled at 10 kHz without filter; 3 %."""
    rate, wn, zeta = 10e3, 56.5, 0.05
    # s^2 / (s^2 + 2 zeta wn s + wn^2) by Tustin's rule, one sample late
    c = 2.0 * rate
    den = np.array(
        [
            c * c + 2 * zeta * wn * c + wn * wn,
            2 * wn * wn - 2 * c * c,
            c * c - 2 * zeta * wn * c + wn * wn,
        ]
    )
    num = np.array([c * c, -2 * c * c, c * c])
    model = IirModel(den[1:] / den[0], num / den[0], 1, 1.0 / rate)
    fb, fa = leaky_integrator(0.05, model.dt)
    bounds = gain_bounds(model, fb, fa, 0.5)
    gain, damping = damping_gain(model, fb, fa, bounds.maximum, 0.4)
    assert damping == 0.4
    b, a = model_polynomials(model)
    closed = np.zeros(8)
    base, loop = multiply(a, fa), multiply(b, fb)
    closed[: len(base)] += base
    closed[: len(loop)] += float(gain) * loop
    poles = np.roots(np.trim_zeros(closed, 'b'))
    pole = poles[np.argmin(np.abs(np.log(poles + 0j) * rate - wn * np.exp(1j * np.arccos(-0.4))))]
    s = np.log(pole) * rate
    assert -s.real / abs(s) == pytest.approx(0.4, rel=0.03)


def test_a_damping_out_of_reach_gives_the_most_there_is(make_isolator):
    model = make_isolator(100.0)
    fb, fa = leaky_integrator(0.5, model.dt)
    bounds = gain_bounds(model, fb, fa, 0.5)
    gain, damping = damping_gain(model, fb, fa, bounds.maximum, 5.0)
    assert gain == bounds.maximum
    assert 0.79 < damping < 5.0


def test_a_mode_that_is_damped_enough_needs_no_gain(make_isolator):
    model = make_isolator(200.0)
    fb, fa = leaky_integrator(0.5, model.dt)
    gain, damping = damping_gain(model, fb, fa, np.array(100.0), 0.5)
    assert gain == 0.0
    assert damping == pytest.approx(0.79, rel=1e-6)


@pytest.mark.parametrize('modulus', [0.9, 0.99, 0.999])
@pytest.mark.parametrize('angle', [0.5, 1.5, 2.8])
def test_a_pole_that_a_zero_cancels_does_not_count(make_isolator, modulus, angle):
    """As identified models of too high an order have them. Truth: the plant without the pair; 1e-3 and the sign."""
    model = make_isolator(200.0, gain=-1.2)
    pole, zero = modulus * np.exp(1j * angle), (modulus - 1e-4) * np.exp(1j * (angle + 1e-4))
    pair, cancel = ([1.0, -2.0 * z.real, abs(z) ** 2] for z in (pole, zero))
    a, b = np.convolve(np.concatenate([[1.0], model.a]), pair), np.convolve(model.b, cancel)
    wider = IirModel(a[1:], b, 1, model.dt)
    fb, fa = leaky_integrator(0.5, model.dt)
    assert polarity(wider, fb, fa) == -1.0
    s = complex(dominant_pole(wider, fb, fa))
    assert s == pytest.approx(complex(dominant_pole(model, fb, fa)), rel=1e-3)
