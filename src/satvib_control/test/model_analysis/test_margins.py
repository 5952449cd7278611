# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from satvib_common.signals.integrator import leaky_integrator
from satvib_control.model_analysis.gain_bounds import gain_bounds
from satvib_control.model_analysis.margins import margins
from satvib_control.model_analysis.transfer import model_polynomials, multiply
from satvib_ident.models.iir_model import IirModel


def largest_pole(model, cb, ca, gain, later=0):
    b, a = model_polynomials(model)
    num, den = np.concatenate([np.zeros(later), multiply(b, cb)]), multiply(a, ca)
    c = np.zeros(max(len(num), len(den)))
    c[: len(den)] += den
    c[: len(num)] += gain * num
    return np.max(np.abs(np.roots(c)))


def test_an_integrator_with_a_delay_has_its_textbook_margins():
    """L = k T z^-1 / (1 - z^-1), k T = 0.2. Truth: |L| = 0.2 / (2 sin(w / 2)) and arg L = -pi/2 - w/2 give the crossing
    2 asin 0.1, the phase margin pi/2 - w/2 and the delay margin that over w; the gain margin is 2 / 0.2."""
    model = IirModel([-0.999999], [1.0], 1, 0.01)
    found = margins(model, [0.2], [1.0], 1.0)
    w = 2.0 * np.arcsin(0.1)
    assert found.phase == pytest.approx(np.pi / 2 - w / 2, rel=1e-4)
    assert found.delay == pytest.approx((np.pi / 2 - w / 2) / w * 0.01, rel=1e-4)
    assert found.gain == pytest.approx(10.0, rel=1e-4)


@pytest.mark.parametrize('rate', [100.0, 200.0, 1000.0])
def test_at_the_bound_the_modulus_margin_is_the_one_asked_for(make_isolator, rate):
    """Truth: the definition of the bound; 1e-3 for the grid."""
    model = make_isolator(rate)
    c = leaky_integrator(0.5, model.dt)
    for margin in (0.3, 0.5, 0.7):
        bounds = gain_bounds(model, *c, margin)
        assert margins(model, *c, bounds.maximum).modulus == pytest.approx(margin, rel=1e-3)
        assert margins(model, *c, bounds.minimum).modulus == pytest.approx(margin, rel=1e-3)


@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_the_gain_margin_is_where_the_loop_becomes_unstable(make_isolator, sign):
    """Truth: closed-loop poles by numpy.roots just below and just above it."""
    model = make_isolator(200.0)
    c = leaky_integrator(0.5, model.dt)
    gain = 60.0 * sign
    factor = float(margins(model, *c, gain).gain)
    assert largest_pole(model, *c, gain * factor * 0.999) < 1.0
    assert largest_pole(model, *c, gain * factor * 1.001) > 1.0


def test_the_delay_margin_is_where_the_loop_becomes_unstable(make_isolator):
    """Truth: closed-loop poles by numpy.roots with whole samples more of delay, at 5 kHz."""
    model = make_isolator(5000.0, wn=56.5, zeta=0.05)
    c = leaky_integrator(0.5, model.dt)
    delay = float(margins(model, *c, 40.0).delay) / model.dt
    assert 2.0 < delay < 200.0
    assert largest_pole(model, *c, 40.0, int(np.floor(delay - 0.02))) < 1.0
    assert largest_pole(model, *c, 40.0, int(np.ceil(delay + 0.02))) > 1.0
