# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Weights on the voltages of the tones. Truth: linear interpolation by NumPy; the definition of the weight."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_control.laws.narrowband.voltage import weight

PLAN = PhasePlan((Phase.STANDBY, Phase.IDENTIFY, Phase.CONTROL), (0, 20, 21), 10**6)
RATE, TONE = 100.0, 7.0


def test_a_weight_lies_between_its_rows():
    rows = np.array([[0.1, 1.0, 0.0], [0.4, 0.5, 0.2], [0.5, 2.0, -1.0]])
    for omega in (0.0, 0.1, 0.2, 0.4, 0.47, 0.5, 3.0):
        parts = [np.interp(omega, rows[:, 0], rows[:, i]) for i in (1, 2)]
        assert weight(rows, omega) == pytest.approx(complex(*parts), abs=1e-15)


def test_the_weight_scales_what_is_left_of_the_tone(make_isolator, make_loop, settings):
    """Truth: with the right model y = (1 - W) d at the tone: 0.3 + 0.1j of it for W = 0.7 - 0.1j; 1 %."""
    model = make_isolator(RATE)
    p = settings(
        sample_rate=RATE, law='narrowband', narrowband_serve='payload', watch_loudness=1000.0,
        narrowband_weights=(1.0, 0.7, -0.1, 40.0, 0.7, -0.1),
    )  # fmt: skip
    loop = make_loop(p, model, PLAN, identified=model)
    k = np.arange(1500)
    y, _ = loop.run(len(k), np.sin(2 * np.pi * TONE * k / RATE))
    line = np.exp(-2j * np.pi * TONE * k[-1000:] / RATE)
    ratio = np.mean(y[-1000:] * line) * 2j
    assert abs(ratio - (0.3 + 0.1j)) < 0.01


@pytest.mark.parametrize(
    'rows', [(), (1.0, 1.0, 0.0), (1.0, 1.0, 0.0, 2.0), (2.0, 1.0, 0.0, 1.0, 1.0, 0.0)]
)
def test_weights_that_are_none_are_refused(settings, rows):
    with pytest.raises(SatvibError, match='narrowband_weights'):
        settings(law='narrowband', narrowband_serve='payload', narrowband_weights=rows)
