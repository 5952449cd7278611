# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Power by frequency, third octaves, criteria for vibration."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from satvib_common.levels import rms
from satvib_experiment.analysis.bands import (
    CRITERIA,
    criterion_limit,
    cumulative_rms,
    integrated,
    met_criterion,
    power_lines,
    third_octaves,
)

DT = 1.0 / 400.0


@pytest.mark.parametrize('count', [4000, 4001])
def test_the_lines_add_up_to_the_mean_square(count):
    """Truth: the RMS of the attenuation table, 1e-12; a tone keeps 0.999 of its power within 2 Hz."""
    t = np.arange(count) * DT
    tone = 3.0 * np.sin(2 * np.pi * 10.0 * t) + 7.0
    noise = np.random.default_rng(1).normal(size=count)
    f, power = power_lines(np.stack([tone, noise], axis=-1), DT)
    assert_allclose(cumulative_rms(power)[0], rms(np.stack([tone, noise], axis=-1)), rtol=1e-12)
    near = np.abs(f - 10.0) < 2.0
    assert power[near, 0].sum() > 0.999 * power[:, 0].sum()


def test_what_is_loud_at_the_edge_of_a_stretch_counts_as_much_as_in_its_middle():
    """Truth: a tone in the first quarter, another in the middle half, each with its own mean square; 8 % in RMS."""
    t = np.arange(4000) * DT
    early = np.where(t < 2.5, 2.0 * np.sin(2 * np.pi * 8.0 * t), 0.0)
    middle = np.where((t >= 2.5) & (t < 7.5), np.sin(2 * np.pi * 30.0 * t), 0.0)
    f, power = power_lines(early + middle, DT)
    assert_allclose(np.sqrt(power[f < 16.0].sum()), np.sqrt(0.5), rtol=0.08)
    assert_allclose(cumulative_rms(power)[f >= 16.0][0], np.sqrt(0.25), rtol=0.08)


def test_a_silent_sensor_has_no_power():
    """Truth: nothing, and no NaN; a sample that is missing counts as the mean."""
    signal = np.stack([np.zeros(800), np.ones(800), np.tile([1.0, -1.0], 400)], axis=-1)
    signal[10, 2] = np.nan
    _, power = power_lines(signal, DT)
    assert not power[:, :2].any()
    assert_allclose(power[:, 2].sum(), 799 / 800, rtol=1e-5)


def test_integration_is_that_of_a_tone():
    """Truth: A / (2 pi f) and A / (2 pi f)^2; 1e-3."""
    t = np.arange(8000) * DT
    f, power = power_lines(2.0 * np.cos(2 * np.pi * 8.0 * t), DT)
    speed = 2.0 / (2 * np.pi * 8.0)
    for times, amplitude in ((1, speed), (2, speed / (2 * np.pi * 8.0))):
        lines = integrated(f, power, times)[f > 7.0]
        assert_allclose(np.sqrt(2.0 * lines.sum()), amplitude, rtol=1e-3)


def test_third_octaves_hold_what_is_in_them():
    """Truth: a tone of 20 Hz is in the band of 10^1.3 Hz; white noise gives each its width; 1 and 10 %."""
    t = np.arange(40_000) * DT
    f, power = power_lines(np.sqrt(2.0) * np.sin(2 * np.pi * 20.0 * t), DT)
    centres, level = third_octaves(f, power)
    at = int(np.argmin(np.abs(centres - 20.0)))
    assert_allclose(centres[at], 10**1.3)
    assert_allclose(level[at], 1.0, rtol=0.01)
    assert np.delete(level, at).max() < 0.01
    f, power = power_lines(np.random.default_rng(2).normal(size=400_000), DT)
    centres, level = third_octaves(f, power, low=5.0)
    width = centres * (10**0.05 - 10**-0.05)
    assert_allclose(level**2, width / 200.0, rtol=0.1)


def test_bands_that_a_short_stretch_cannot_tell_are_left_out():
    """Truth: 2 s have lines of 0.5 Hz; a third octave is wider than that from 2.5 Hz on."""
    f, power = power_lines(np.random.default_rng(3).normal(size=800), DT)
    centres, _ = third_octaves(f, power)
    assert centres[0] == pytest.approx(10**0.4)


def test_the_criteria():
    """Truth: C. G. Gordon's table: VC-A 50 um/s from 8 to 80 Hz and 260 ug below it, VC-C 12.5 um/s from 1 Hz on."""
    limits = {c.name: criterion_limit(c, np.array([2.0, 4.0, 8.0, 80.0])) for c in CRITERIA}
    assert_allclose(limits['VC-A'], [np.nan, 100e-6, 50e-6, 50e-6])
    assert_allclose(2 * np.pi * 4.0 * limits['VC-A'][1] / 9.80665, 256e-6, rtol=0.02)
    assert_allclose(limits['VC-C'], 12.5e-6)
    assert_allclose(limits['workshop (ISO)'][2:], 800e-6)
    centres = np.array([4.0, 10.0, 50.0])
    assert met_criterion(centres, np.array([90e-6, 49e-6, 20e-6])) == 'VC-A'
    assert met_criterion(centres, np.array([3e-6, 3e-6, 3e-6])) == 'VC-E'
    assert met_criterion(centres, np.array([1e-6, 900e-6, 1e-6])) == ''
