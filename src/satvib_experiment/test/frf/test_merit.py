# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Peak, beginning of isolation and roll-off of known curves."""

import numpy as np
import pytest
from satvib_experiment.frf.merit import merit_of
from satvib_ident.frequency.response import FrequencyResponse


def response(f, value, coherence=1.0):
    ones = np.ones_like(f)
    return FrequencyResponse(f, value + 0j, coherence * ones, 0.001 * np.abs(value), 10.0, 0.95, '')


def test_an_undamped_oscillator():
    """Truth: |1 / (1 - (f / f0)^2)|: 0 dB again at sqrt(2) f0, -40 dB per decade far above; 0.1 %, 1.5 dB a decade."""
    f = np.linspace(1.0, 300.0, 6000)
    f0 = 10.0
    found = merit_of(response(f, 1.0 / np.maximum(np.abs(1.0 - (f / f0) ** 2), 1e-2)))
    assert found.isolation_from == pytest.approx(np.sqrt(2.0) * f0, rel=1e-3)
    assert found.roll_off == pytest.approx(-40.0, abs=1.5)
    assert found.peak == pytest.approx(40.0, abs=0.01)
    assert found.peak_frequency == pytest.approx(f0, abs=0.1)
    assert found.roll_off_from == pytest.approx(2.0 * found.isolation_from, rel=0.01)


def test_lines_without_coherence_say_nothing():
    """Truth: no line of coherence 0.5, no figures."""
    f = np.linspace(1.0, 50.0, 50)
    assert merit_of(response(f, np.ones_like(f), coherence=0.3)) is None


def test_no_isolation_in_the_band():
    """Truth: a curve above 0 dB at the end of the band begins no isolation, and has no roll-off."""
    f = np.linspace(1.0, 12.0, 50)
    found = merit_of(response(f, 1.0 + f))
    assert found.isolation_from is None
    assert found.roll_off is None
