# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The tracker: no bias where an AR(2) fit has one, the spread of its theory, no lag behind a chirp."""

import numpy as np
import pytest
from satvib_control.laws.narrowband.memory import Setting, Tone, Tracking
from satvib_control.laws.narrowband.tracker import begin, correct, predict

RATE = 800.0


def track(signals, frequency, noise, amplitude=1.0, settling=0.1, memory=4.0, low=1.0, high=399.0):
    """Run the tracker, begun near the tone, on (samples, trials); gives frequencies (samples, trials) in Hz."""
    length, trials = signals.shape
    settings = np.zeros(len(Setting))
    settings[Setting.PACE], settings[Setting.LONGEST] = settling * RATE, memory * RATE
    settings[Setting.LOW], settings[Setting.HIGH] = np.array([low, high]) * 2.0 * np.pi / RATE
    settings[Setting.WINDOW] = 200.0
    out = np.zeros((length, trials))
    for i in range(trials):
        tones, tracking = np.zeros((1, len(Tone))), np.zeros(len(Tracking))
        tracking[Tracking.STRETCH] = 1.0
        floor = np.full(5, noise**2)
        begin(tones[0], (frequency + 0.3) * 2.0 * np.pi / RATE, 0.0, -amplitude)
        for k in range(length):
            e = signals[k, i] - predict(tones)
            correct(tones, settings, tracking, floor, 1.0, e)
            out[k, i] = tones[0, Tone.OMEGA] * RATE / (2.0 * np.pi)
    return out


def tone(frequency, length, noise, trials, seed):
    """Sines of amplitude 1 in white noise, (length, trials)."""
    t = np.arange(length)[:, None] / RATE
    rng = np.random.default_rng([seed, int(frequency)])
    return np.sin(2.0 * np.pi * frequency * t) + noise * rng.standard_normal((length, trials))


@pytest.mark.parametrize('frequency', [50.0, 72.5, 95.0])
def test_no_bias_at_the_bands_edges(frequency):
    """Truth: the frequency put in. The mean over trials may be off by three standard deviations of the mean.

    The same data fitted by AR(2) least squares are off by more than 0.2 Hz at every one of these frequencies.
    """
    y = tone(frequency, 4800, 0.2, 12, 1)
    late = track(y, frequency, 0.2)[3200:].mean(axis=0)
    assert abs(late.mean() - frequency) < 3.0 * late.std(ddof=1) / np.sqrt(12) + 1e-5
    ar = []
    for i in range(12):
        v = y[:, i]
        phi = np.column_stack([v[1:-1], v[:-2]])
        a = np.linalg.lstsq(phi, v[2:], rcond=None)[0]
        ar.append(abs(np.angle(np.roots([1.0, *-a])[0])) * RATE / (2.0 * np.pi))
    assert abs(np.mean(ar) - frequency) > 0.2


def test_spread_is_that_of_the_linear_theory():
    """Truth: a loop of phase and frequency with the gains 1 / n and 2 / (n N), driven by white psi, has

    var w = 4 s^2 / (A^2 N^2 n),  s^2 the noise and A the amplitude. 16 trials tell a deviation to 18 %; 40 % allowed.
    No estimator can be better than 24 s^2 / (A^2 L^3) after L samples (Cramer, Rao).
    """
    noise, length, memory, pace = 0.2, 8000, 800.0, 80.0
    got = track(tone(80.0, length, noise, 16, 2), 80.0, noise, memory=memory / RATE)[-1]
    spread = np.sqrt(np.mean((got - 80.0) ** 2)) * 2.0 * np.pi / RATE
    assert spread == pytest.approx(np.sqrt(4.0 * noise**2 / (memory**2 * pace)), rel=0.4)
    assert spread > np.sqrt(24.0 * noise**2 / length**3)


def test_a_chirp_leaves_no_lag():
    """Truth: the frequency put in, 10 Hz/s; a filter without a rate would lag by its memory times the rate."""
    t = np.arange(3200) / RATE
    f = np.where(t < 1.0, 50.0, 50.0 + 10.0 * (t - 1.0))
    rng = np.random.default_rng(6)
    y = np.sin(2.0 * np.pi * np.cumsum(f) / RATE)[:, None] + 0.1 * rng.standard_normal((3200, 4))
    error = track(y, 50.0, 0.1) - f[:, None]
    assert np.abs(error[2000:].mean(axis=0)).max() < 0.05
    assert np.abs(error[2000:]).max() < 0.3


def test_a_jump_is_caught():
    """Truth: the frequency put in, 10 Hz up; within 0.6 s to 0.5 Hz, and after 2 s to 0.05 Hz.

    By the tracker alone; in the law the search helps.
    """
    f = np.where(np.arange(3200) < 1600, 60.0, 70.0)
    rng = np.random.default_rng(7)
    y = np.sin(2.0 * np.pi * np.cumsum(f) / RATE)[:, None] + 0.1 * rng.standard_normal((3200, 4))
    error = np.abs(track(y, 60.0, 0.1) - f[:, None])
    assert error[2080:].max() < 0.5
    assert error[-1].max() < 0.05


def loop_matrix(rotation, ratio):
    """Linearized loop per pace: relative amplitude, phase, frequency, rate; e turned by `rotation`, N = ratio n."""
    c, s = np.cos(rotation), np.sin(rotation)
    re, im = np.array([-c, s, 0.0, 0.0]), np.array([-s, -c, 0.0, 0.0])
    m = np.array([re, im, 2.0 / ratio * im, 1.5 * im / ratio**2])
    m[1, 2] += 1.0
    m[2, 3] += 1.0
    return m


@pytest.mark.parametrize('ratio', [6.0, 10.0, 50.0, 500.0])
@pytest.mark.parametrize('degrees', [-80.0, -50.0, 0.0, 50.0, 80.0])
def test_linearized_loop_stands_80_degrees(ratio, degrees):
    """Truth: eigenvalues of the linearized, averaged loop of the docstring; all left of the axis, not so at 95."""
    assert np.linalg.eigvals(loop_matrix(np.radians(degrees), ratio)).real.max() < 0.0
    assert np.linalg.eigvals(loop_matrix(np.radians(95.0), ratio)).real.max() > 0.0
