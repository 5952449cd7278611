# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is odd about a signal is said with its share, and what is not odd is not.

Truth everywhere: the fault that was put into a signal, and its share.
"""

import numpy as np
import pytest
from satvib_common.records.checks import check_signal

N = 2000
GENERATOR = np.random.default_rng([4])
NOISE = GENERATOR.normal(size=N)
SMOOTH = np.convolve(NOISE, np.ones(20) / 20.0, 'same')
PRBS = np.repeat(GENERATOR.choice([-1.0, 1.0], N // 4), 4)


def with_outliers():
    x = SMOOTH.copy()
    x[[300, 900, 1500]] = [5.0, -5.0, 100.0]
    return x


def stuck():
    x = NOISE.copy()
    x[500:600] = x[500]
    return x


@pytest.mark.parametrize(
    ('signal', 'said'),
    [
        (NOISE + 981.0, 'an offset'),
        (24.0 + 0.1 * PRBS, 'an offset'),
        (np.clip(SMOOTH, -0.2, 10.0), 'smallest value, -0.2: probably clipped'),
        (np.clip(NOISE, -9.0, 1.0), 'largest value, 1: probably clipped'),
        (stuck(), 'holds one value for up to 100 samples, 5 %'),
        (with_outliers(), '3 samples (0.15 %) stand apart'),
        (NOISE + 0.01 * np.arange(N), 'a straight line is 97 % of its variance'),
        (np.rint(5.0 * NOISE), 'whole numbers'),
        (0.25 * np.rint(4.0 * NOISE), 'moves in steps of 0.25'),
    ],
)
@pytest.mark.parametrize('unit', [1.0, 1e-12, 1e12])
def test_a_fault_is_said(signal, said, unit):
    if unit != 1.0:
        said = said.split(',')[0].split(' of 0.25')[0]
    if said == 'whole numbers' and unit != 1.0:
        pytest.skip('whole numbers have no unit')
    assert any(said in line for line in check_signal('output', unit * signal)), check_signal(
        'output', signal
    )


@pytest.mark.parametrize(
    'signal',
    [
        NOISE,
        SMOOTH,
        PRBS,
        np.sin(0.05 * np.arange(N)),
        np.round(NOISE, 2),
        np.zeros(N),
        np.full(N, 3.0),
    ],
)
def test_a_sound_signal_is_left_alone(signal):
    assert check_signal('input', signal) == []


def test_missing_samples_do_not_matter():
    x = NOISE.copy()
    x[::7] = np.nan
    assert check_signal('output', x) == []
    assert check_signal('output', np.full(N, np.nan)) == []
