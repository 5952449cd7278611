# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of a judgement, from responses that have a closed form."""

import numpy as np
import pytest
from satvib_experiment.frf.curve import TRANSMISSIBILITY, Curve
from satvib_ident.frequency.response import FrequencyResponse
from satvib_studies.isolation.numbers import judged, judged_seed

BAND = (40.0, 80.0)
F = np.arange(1.0, 80.1, 0.1)


def curve(output, mode, damping, factor=1.0, coherence=1.0):
    """Payload over base of a damper between both: 2nd order with a zero."""
    s = 1j * F / mode
    value = factor * (1.0 + 2.0 * damping * s) / (1.0 + 2.0 * damping * s + s * s)
    ones = np.ones(F.size)
    response = FrequencyResponse(
        frequency=F, value=value, coherence=coherence * ones, radius=1e-3 * np.abs(value),
        averages=ones, confidence=0.95, method='closed form',
    )  # fmt: skip
    return Curve(TRANSMISSIBILITY, 'open', output, 'base', response)


def test_figures_of_an_isolator_of_the_second_order():
    """Truth: |T|^2 = (1 + (2 z r)^2) / ((1 - r^2)^2 + (2 z r)^2), r = f / 9 Hz; its 1 at sqrt(2) 9 Hz."""
    still = [
        curve('strut_1', 9.0, 0.05),
        curve('heave', 9.0, 0.05),
        curve('tilt_x', 9.0, 0.05, 0.1),
    ]
    found = judged_seed(still, still, BAND)

    def level(f, z):
        r = f / 9.0
        return 10.0 * np.log10((1 + (2 * z * r) ** 2) / ((1 - r * r) ** 2 + (2 * z * r) ** 2))

    assert found.peak == pytest.approx(level(F, 0.05).max(), abs=1e-9)
    assert found.strut_peak == found.peak
    assert found.tilt_peak == pytest.approx(found.peak - 20.0, abs=1e-9)
    assert found.isolation_from == pytest.approx(np.sqrt(2.0) * 9.0, rel=1e-3)
    assert found.worse == 0.0
    span = np.log10(BAND[1] / BAND[0])
    assert found.roll_off == pytest.approx(
        (level(BAND[1], 0.05) - level(BAND[0], 0.05)) / span, abs=0.5
    )
    damped = [curve(c.output, 9.0, 0.5) for c in still]
    better = judged_seed(damped, still, BAND)
    assert better.worse == pytest.approx((level(F, 0.5) - level(F, 0.05)).max(), abs=1e-9)
    assert better.worse_at == pytest.approx(F[np.argmax(level(F, 0.5) - level(F, 0.05))])


def test_what_is_not_coherent_is_not_judged():
    """Truth: coherence 0.4 everywhere, below the 0.5 of a trusted line."""
    vague = [curve('strut_1', 9.0, 0.05, 1.0, 0.4), curve('heave', 9.0, 0.05, 1.0, 0.4)]
    found = judged([vague, vague], [vague, vague], BAND)
    for name in ('peak', 'strut_peak', 'isolation_from', 'roll_off', 'worse', 'tilt_peak'):
        assert np.isnan(getattr(found, name)).tolist() == [True, True]
