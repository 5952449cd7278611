# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Levels and their ratio, against closed forms."""

import numpy as np
import pytest
from satvib_common.levels import decibel, rms, rms_with_mean

T = np.arange(1000) * 0.01


def test_rms_of_a_sine_without_its_offset():
    """Closed form: A / sqrt(2) over whole periods, whatever the offset; rounding only."""
    signal = np.stack([3.0 * np.sin(2 * np.pi * 10 * T) + 7.0, np.cos(2 * np.pi * 4 * T)], axis=1)
    np.testing.assert_allclose(rms(signal), [3.0 / np.sqrt(2), 1 / np.sqrt(2)], rtol=1e-12)


def test_rms_leaves_missing_samples_out():
    """Closed form: the RMS of +-1 is 1."""
    signal = np.where(np.arange(100) % 2, 1.0, -1.0)
    signal[[10, 11, 50, 51]] = np.nan
    assert rms(signal) == pytest.approx(1.0, abs=1e-12)


def test_decibels():
    """Eq. (42): ten times less is -20 dB; nothing is claimed about nothing."""
    np.testing.assert_allclose(
        decibel(np.array([0.1, 2.0]), np.array([1.0, 1.0])), [-20, 6.0206], rtol=1e-5
    )
    assert np.isnan(decibel(np.array(0.0), np.array(1.0)))
    assert np.isnan(decibel(np.array(1.0), np.array(0.0)))
    assert np.isnan(decibel(np.array(np.nan), np.array(1.0)))


def test_rms_with_the_mean():
    """Truth: a sine of amplitude 2 on a mean of 3, over whole periods: sqrt(2 + 9); 1e-12."""
    sine = 3.0 + 2.0 * np.sin(2.0 * np.pi * np.arange(100) / 20.0)
    signal = np.column_stack([sine, -sine])
    np.testing.assert_allclose(rms_with_mean(signal), [np.sqrt(11.0)] * 2, rtol=1e-12)
