# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The watched sensitivity against an independent transfer function, and the margin kept on a model that needs it."""

import numpy as np
import pytest
import scipy.signal
from satvib_common.phases import Phase
from satvib_control.laws.base import LawInput
from satvib_control.laws.narrowband.margin import largest_sensitivity, margin_grid
from satvib_control.laws.narrowband.memory import UNCORRECTED, Tone, Tracking
from satvib_control.laws.registry import make_law
from satvib_control.model_analysis.transfer import model_polynomials, respond
from satvib_ident.models.iir_model import IirModel

RATE = 400.0


def lightly_damped(r=0.99, f=30.0):
    """A resonance near the tones: what asks for the margin."""
    w = 2.0 * np.pi * f / RATE
    return IirModel([-2.0 * r * np.cos(w), r * r], [0.3, -0.2, 0.1], 2, 1.0 / RATE)


def test_response_equals_scipy():
    """Truth: scipy.signal.freqz; 1e-12."""
    b, a = model_polynomials(lightly_damped())
    for w in (0.01, 0.5, 3.0):
        assert respond(b, a, w) == pytest.approx(scipy.signal.freqz(b, a, [w])[1][0], rel=1e-12)


@pytest.mark.parametrize('frequencies', [(25.0,), (25.0, 40.0), (12.0, 25.0, 60.0)])
def test_sensitivity_equals_the_observer_s_own_response(frequencies):
    """Truth: 1 - G Q by the z-transform of the observer's impulse response, run sample by sample; 1e-6."""
    model, pace = lightly_damped(), 20.0
    b, a = model_polynomials(model)
    omega = 2.0 * np.pi * np.array(frequencies) / RATE
    inverse = np.array([1.0 / respond(b, a, w) for w in omega])
    x = np.zeros(len(omega), dtype=complex)
    q = np.zeros(3000)
    for k in range(len(q)):
        x = x * np.exp(1j * omega)
        x = x + 2.0 / pace * ((k == 0) - x.real.sum())
        q[k] = (x * inverse).real.sum()
    grid = margin_grid(*model_polynomials(model))
    response = scipy.signal.freqz(q, 1.0, grid[:, 0])[1]
    want = np.abs(1.0 - (grid[:, 1] + 1j * grid[:, 2]) * response).max()
    tones = np.zeros((len(omega), len(Tone)))
    tones[:, Tone.OMEGA], tones[:, Tone.PACE] = omega, pace
    tones[:, Tone.ON] = tones[:, Tone.FADE] = 1.0
    assert largest_sensitivity(tones, inverse, grid, UNCORRECTED) == pytest.approx(want, rel=1e-6)


def test_grid_holds_the_resonance():
    """Truth: the peak of |G| on a grid 200 times as fine; 1 %."""
    model = lightly_damped(r=0.999)
    grid = margin_grid(*model_polynomials(model))
    fine = np.abs(model.frequency_response(np.linspace(29.0, 31.0, 4001))).max()
    assert np.hypot(grid[:, 1], grid[:, 2]).max() > 0.99 * fine


@pytest.mark.parametrize('margin', [0.2, 0.4, 0.7, 0.9])
def test_margin_is_kept(settings, margin):
    """Truth: the setting. Once the tone is settled max |S| is not above its inverse; a larger margin costs pace.

    At its shortest pace this tone has max |S| = 4.5 on this model, so only the margin of 0.2 costs nothing.
    """
    model = lightly_damped()
    p = settings(
        sample_rate=RATE, law='narrowband', modulus_margin=margin, narrowband_settling=0.05
    )
    law = make_law('narrowband', p, 1.0 / RATE, (1,))
    yes = np.ones(1, dtype=bool)
    law.set_model(IirModel(model.a[None], model.b[None], 2, 1.0 / RATE), yes)
    plant = scipy.signal.lfilter
    b, a = model_polynomials(model)
    state = np.zeros(len(a) - 1)
    rng = np.random.default_rng(8)
    u = np.zeros(1)
    for k in range(4000):
        y = state[0] + np.sin(2.0 * np.pi * 25.0 * k / RATE) + 0.02 * rng.standard_normal()
        u = law.step(LawInput(k, np.array([y]), np.array([np.nan]), u, ~yes, yes), Phase.CONTROL)
        _, state = plant(b, a, u, zi=state)
    assert law.state.sensitivity[0] <= 1.0 / margin
    assert law.tones()[0][0, 0] == pytest.approx(25.0, abs=0.02)
    stretched = law._memory.tracking[0, Tracking.STRETCH] > 1.0
    assert stretched == (margin > 1.0 / 4.5)
