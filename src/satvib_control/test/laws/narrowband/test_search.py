# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The search for tones: its spectrum and its noise level against NumPy, its judgement on made signals."""

import numpy as np
import pytest
from satvib_common.phases import Phase
from satvib_control.laws.base import LawInput
from satvib_control.laws.narrowband.search import AROUND, _levels, spectrum
from satvib_control.laws.registry import make_law
from satvib_ident.models.iir_model import IirModel


def listen(settings, signals, rate=200.0, **keywords):
    """A law that only listens to (samples, trials) signals, at 0 V; gives the law."""
    count = signals.shape[1]
    law = make_law(
        'narrowband',
        settings(sample_rate=rate, law='narrowband', **keywords),
        1.0 / rate,
        (count,),
    )
    yes = np.ones(count, dtype=bool)
    law.set_model(IirModel(np.zeros((count, 1)), np.ones((count, 1)), 1, 1.0 / rate), yes)
    zero, nan = np.zeros(count), np.full(count, np.nan)
    for k, y in enumerate(signals):
        law.step(LawInput(k, y, nan, zero, ~yes, yes), Phase.STANDBY)
    return law


def test_spectrum_equals_its_definition():
    """Truth: the sum of its definition by NumPy, from the oldest sample of a turned ring; 1e-9 relative."""
    rng = np.random.default_rng(1)
    ring, pointer = rng.standard_normal(50), 17
    out = np.zeros(20)
    spectrum(ring, pointer, 0.1, 0.13, out)
    h = 0.5 - 0.5 * np.cos(2.0 * np.pi * (np.arange(50) + 0.5) / 50)
    x = h * np.roll(ring, -pointer)
    w = 0.1 + 0.13 * np.arange(20)
    want = np.abs(np.exp(-1j * np.outer(w, np.arange(50))) @ x) ** 2 / np.sum(h**2)
    np.testing.assert_allclose(out, want, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize('count', [5, 25, 60])
def test_levels_equal_a_sort(count):
    """Truth: numpy.sort of the same neighbours. Exact."""
    power = np.random.default_rng(count).exponential(size=count)
    out = np.zeros(count)
    _levels(power, out)
    size = min(AROUND, count)
    for q in range(count):
        first = min(max(q - size // 2, 0), count - size)
        assert out[q] == np.sort(power[first : first + size])[size // 4] / 0.2877


@pytest.mark.parametrize(
    'frequencies', [(10.0,), (20.0, 31.0), (10.0, 14.0, 23.0), (61.3, 70.9, 80.2)]
)
def test_finds_tones_that_were_there_from_the_beginning(settings, frequencies):
    """Truth: the frequencies put in, at 10 dB over white noise; 0.05 Hz after 6 s.

    Two that are two resolutions of the window apart may be taken for one at first, which costs about two seconds.
    """
    t = np.arange(1200) / 200.0
    rng = np.random.default_rng(3)
    noise = rng.standard_normal((1200, 6))
    phases = rng.uniform(0.0, 2.0 * np.pi, (len(frequencies), 6))
    y = noise.copy()
    for f, phase in zip(frequencies, phases, strict=True):
        y += np.sqrt(20.0) * np.sin(2.0 * np.pi * f * t[:, None] + phase)
    found = listen(settings, y).tones()[0]
    for trial in range(6):
        got = np.sort(found[trial])
        np.testing.assert_allclose(got[: len(frequencies)], frequencies, atol=0.05)
        assert np.isnan(got[len(frequencies) :]).all()


def test_finds_a_weak_tone_by_its_constancy(settings):
    """Truth: the frequency put in, 1 dB below white noise, there from the beginning: 16 s to 0.2 Hz.

    Its P is 13 times the noise, below the 25 times that one look asks for.
    """
    t = np.arange(3200) / 200.0
    rng = np.random.default_rng(6)
    y = rng.standard_normal((3200, 6)) + np.sqrt(2.0 * 10.0**-0.1) * np.sin(
        2.0 * np.pi * 24.0 * t[:, None] + rng.uniform(0.0, 2.0 * np.pi, 6)
    )
    found = listen(settings, y).tones()[0]
    assert np.nanmax(np.abs(found - 24.0)) < 0.2
    assert (np.isfinite(found).sum(axis=-1) == 1).all()


def test_noise_is_no_tone(settings):
    """Truth: there is no tone in white noise, nor in noise of a mode with 10 % damping; 20 trials of 20 s."""
    from scipy.signal import lfilter

    white = np.random.default_rng(4).standard_normal((4000, 20))
    r, w = np.exp(-0.1 * 2 * np.pi * 12.0 / 200.0), 2 * np.pi * 12.0 / 200.0
    coloured = lfilter([1.0], [1.0, -2.0 * r * np.cos(w), r * r], white, axis=0)
    for y in (white, coloured):
        law = listen(settings, y)
        # a false find is let go within a second; so at the end at most one trial in twenty has one
        assert np.isfinite(law.tones()[0]).any(axis=-1).sum() <= 1


def test_a_tone_that_ends_is_let_go(settings):
    """Truth: after its end there is nothing to track."""
    t = np.arange(1600) / 200.0
    y = np.where(t < 4.0, np.sin(2.0 * np.pi * 15.0 * t), 0.0)
    y = y + 0.1 * np.random.default_rng(5).standard_normal(1600)
    assert np.isfinite(listen(settings, y[:800, None]).tones()[0]).sum() == 1
    assert np.isnan(listen(settings, y[:, None]).tones()[0]).all()


def test_smallest_amplitude_that_is_worth_a_voltage(settings):
    """Truth: the setting; a tone of 0.1 is left alone when 0.2 is asked for."""
    y = 0.1 * np.sin(2.0 * np.pi * 15.0 * np.arange(800) / 200.0)[:, None]
    assert np.isfinite(listen(settings, y).tones()[0]).any()
    assert np.isnan(listen(settings, y, narrowband_smallest=0.2).tones()[0]).all()
