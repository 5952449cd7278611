# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which lines an input excites. Truth: what it is made of; a first-order lag is the system, with noise at both ends."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_experiment.frf.how import Moved, estimate, period_samples
from satvib_experiment.frf.lines import OnlyTones
from satvib_ident.frequency.settings import FrfSettings
from scipy.signal import chirp, lfilter

DT = 1.0 / 200.0
TIME = np.arange(8000) * DT


def tones(*frequencies):
    return sum(np.sin(2 * np.pi * f * TIME + f * f) for f in frequencies)


def measured(x, noise=0.01, window='hann'):
    rng = np.random.default_rng(3)
    y = lfilter([0.4], [1.0, -0.6], x)
    x, y = (signal + noise * rng.normal(size=signal.size) for signal in (x, y))
    return estimate(x, y, DT, Moved(), FrfSettings(window=window))


@pytest.mark.parametrize('window', ['hann', 'hamming', 'blackman', 'flattop', 'boxcar'])
@pytest.mark.parametrize('noise', [0.0, 0.01])
@pytest.mark.parametrize('frequencies', [(9.0,), (9.2345,), (9.0, 40.0), (11.3, 22.6, 33.9)])
def test_tones_give_no_curve(frequencies, noise, window):
    """Tolerance of the frequency: a line, 0.21 Hz."""
    with pytest.raises(OnlyTones, match='Hz only: no curve') as caught:
        measured(tones(*frequencies), noise, window)
    np.testing.assert_allclose(caught.value.frequencies, frequencies, atol=0.22)


@pytest.mark.parametrize(
    ('x', 'low', 'high'),
    [
        (np.random.default_rng(1).normal(size=TIME.size), 1.0, 99.0),
        (chirp(TIME, 2.0, TIME[-1], 80.0), 3.0, 79.0),
        (tones(*np.arange(1.0, 80.0, 0.5)), 1.5, 79.0),
        (np.repeat(np.geomspace(2.0, 80.0, 32), 250), 3.0, 75.0),
        (0.05 * np.random.default_rng(1).normal(size=TIME.size) + 10 * tones(50.0), 1.0, 49.0),
    ],
    ids=['noise', 'sweep', 'multisine', 'steps', 'noise with a loud tone'],
)
def test_what_is_broadband_keeps_its_band(x, low, high):
    """Tolerance: 1 dB where the coherence is above 0.99."""
    if x.max() > 79.0 and x.min() > 1.9:  # frequencies of steps
        x = np.sin(2 * np.pi * np.cumsum(x) * DT)
    found = measured(x, noise=1e-3)
    assert found.frequency[0] <= low
    assert found.frequency[-1] >= high
    sure = found.coherence > 0.99
    assert np.sum(sure) > 30
    exact = 0.4 / np.abs(1.0 - 0.6 * np.exp(-2j * np.pi * found.frequency[sure] * DT))
    assert np.max(np.abs(20 * np.log10(found.magnitude[sure] / exact))) < 1.0


@pytest.mark.parametrize(
    ('moved', 'said'),
    [
        (Moved(10.0, 12.0, whole=True), 'between 11.11 and 10.8 Hz'),
        (Moved(10.0, 10.02), 'between 10 and 10.02 Hz'),
        (Moved(10.02, 10.05, period=2000), 'between 10.02 and 10.05 Hz'),
        (Moved(steps=((5.0, 100, TIME.size + 1),)), 'no whole step'),
    ],
    ids=['sweep', 'random', 'multisine', 'step'],
)
def test_a_band_without_a_line_is_said(moved, said):
    """Truth: of a sweep 0.9 of the band is used at either end, and the lines are 0.2 or 0.1 Hz apart."""
    x = np.random.default_rng(1).normal(size=TIME.size)
    with pytest.raises(SatvibError, match=said):
        estimate(x, x, DT, moved, FrfSettings())


@pytest.mark.parametrize('period', [0.013, 0.01, 0.001])
def test_a_period_is_a_whole_number_of_samples(period):
    """Two samples have a mean and half the sample rate, and no line between them."""
    with pytest.raises(SatvibError, match=r'--period: .* no whole number of samples of 0\.005 s'):
        period_samples(period, DT)
    assert period_samples(0.015, DT) == 3
