# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an attempt shows of the plant at the tone, where D and the ratio of truth to model are put in."""

import numpy as np
import pytest
from satvib_control.laws.narrowband.memory import UNCORRECTED, Setting
from satvib_control.laws.narrowband.model_correction import (
    begin_attempt,
    correct_model,
    corrected,
    factor,
    learn,
    turned,
)

PACE = 20.0
OMEGA = 0.314


def attempt(correction, ratio, paces=10.0, slip=0.0, noise=0.0, seed=1, stray=0.0, heard=OMEGA):
    """An attempt whose effect v in the model grows e-fold in three paces: y = d + ratio v; give whether corrected.

    The tracker ends at a frequency that is off by the share `stray`.
    """
    settings = np.zeros(len(Setting))
    settings[Setting.PACE] = PACE
    rng = np.random.default_rng(seed)
    begin_attempt(correction, OMEGA + slip)
    for k in range(round(paces * PACE)):
        turn = np.exp(1j * OMEGA * k)
        v = 0.1 * (np.exp(k / (3.0 * PACE)) - 1.0) * turn * np.exp(0.7j)
        y = (turn + ratio * v).real + noise * rng.standard_normal()
        learn(correction, settings, OMEGA * (1.0 + stray * k / (paces * PACE)), y, v.real)
    return correct_model(correction, heard)


@pytest.mark.parametrize('degrees', [0.0, 60.0, 120.0, 180.0, -90.0])
@pytest.mark.parametrize('size', [0.5, 1.0, 2.0])
def test_the_ratio_is_found(degrees, size):
    """Truth: the ratio put in; 12 %, for smoothing over a pace leaves 1 / (2 w n), 8 %, of twice the frequency."""
    ratio = size * np.exp(1j * np.radians(degrees))
    correction = UNCORRECTED.copy()
    assert attempt(correction, ratio)
    assert factor(correction, OMEGA) == pytest.approx(ratio, abs=0.12 * size)


def test_noise_and_a_frequency_that_is_not_quite_known():
    """Truth: the ratio put in. Noise of half the tone, 0.1 Hz of 10: the loop bears 80 degrees, 30 are allowed."""
    ratio = 1.2 * np.exp(2.0j)
    for seed in range(20):
        correction = UNCORRECTED.copy()
        assert attempt(correction, ratio, slip=0.01 * OMEGA, noise=0.5, seed=seed)
        found = factor(correction, OMEGA) / ratio
        assert abs(np.angle(found, deg=True)) < 30.0
        assert abs(found) == pytest.approx(1.0, abs=0.35)


def test_a_second_correction_builds_on_the_first():
    """Truth: the product, 20 %. The model of the second time has the first correction in it."""
    correction = UNCORRECTED.copy()
    assert attempt(correction, 1.5j)
    assert attempt(correction, 0.8 - 0.3j)
    assert factor(correction, OMEGA) == pytest.approx(1.5j * (0.8 - 0.3j), rel=0.2)


def test_the_corrected_effect_of_a_tone_is_turned_by_the_ratio():
    """Truth: the closed form for a steady tone; 1e-12 after the first sample."""
    correction = UNCORRECTED.copy()
    attempt(correction, 1.3 * np.exp(2.2j))
    ratio = factor(correction, OMEGA)
    turn = np.exp(1j * OMEGA * np.arange(50))
    effect = [corrected(correction, v) for v in turn.real]
    np.testing.assert_allclose(effect[1:], (ratio * turn).real[1:], atol=1e-12)


def test_an_uncorrected_model_is_as_it_was():
    """Exact, to the bit: without a failed attempt nothing changes."""
    v = np.random.default_rng(1).standard_normal(100)
    correction = UNCORRECTED.copy()
    assert [corrected(correction, x) for x in v] == v.tolist()
    assert factor(correction, OMEGA) == 1.0


def test_what_shows_nothing_changes_nothing():
    """No attempt, an attempt without voltage, and noise that a voltage has nothing to do with."""
    correction = UNCORRECTED.copy()
    assert not correct_model(correction, OMEGA)
    settings = np.zeros(len(Setting))
    settings[Setting.PACE] = PACE
    rng = np.random.default_rng(2)
    for effect in (0.0, 1.0):
        begin_attempt(correction, OMEGA)
        for k in range(400):
            learn(
                correction,
                settings,
                OMEGA,
                rng.standard_normal(),
                effect * np.cos(OMEGA * k) * k / 400,
            )
        assert not correct_model(correction, OMEGA)
    assert factor(correction, OMEGA) == 1.0


@pytest.mark.parametrize(
    ('degrees', 'stray', 'noise', 'expected'),
    [
        (75.0, 0.1, 0.0, True),
        (-100.0, -0.1, 0.0, True),
        (75.0, 0.0, 0.0, False),
        (30.0, 0.1, 0.0, False),
        (75.0, 0.1, 10.0, False),
    ],
)
def test_a_turned_model_is_known_by_a_frequency_that_strayed(degrees, stray, noise, expected):
    """Truth: the ratio put in. Less than 60 degrees, a frequency that stays or noise ten times the tone are none."""
    correction = UNCORRECTED.copy()
    ratio = np.exp(1j * np.radians(degrees))
    attempt(correction, ratio, paces=15.0, stray=stray, noise=noise)
    assert turned(correction) == expected


def test_a_tone_that_moved_corrects_nothing():
    """Heard a fifth away or not at all: corrected; at twice the frequency it was not one tone."""
    for heard, expected in ((1.2 * OMEGA, True), (0.0, True), (2.0 * OMEGA, False)):
        correction = UNCORRECTED.copy()
        assert attempt(correction, 2.0j, heard=heard) == expected
        assert (factor(correction, OMEGA) != 1.0) == expected


def test_another_tone_takes_the_model_as_it_was():
    """A fifth away keeps the correction, twice the frequency does not."""
    correction = UNCORRECTED.copy()
    attempt(correction, 2.0j)
    begin_attempt(correction, 1.2 * OMEGA)
    assert abs(factor(correction, OMEGA)) > 1.9
    begin_attempt(correction, 2.0 * OMEGA)
    assert factor(correction, OMEGA) == 1.0
