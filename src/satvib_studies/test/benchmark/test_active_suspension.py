# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Law narrowband on the international benchmark's measured noise, beside an oracle that knows every frequency.

The benchmark itself is benchmarks/active_suspension.py; its tables are in docs/narrowband.md.
"""

import numpy as np
import pytest
from satvib_studies.benchmark import active_suspension as bench
from satvib_studies.benchmark import active_suspension_protocol as asp

pytestmark = pytest.mark.skipif(
    not asp.data_path().exists(), reason=f'no benchmark data at {asp.data_path()}'
)


@pytest.fixture(scope='module')
def plant():
    return asp.load_plant()


def test_oracle_cancels_what_it_is_asked_to(plant):
    """Truth: with no noise an observer of the right frequency leaves nothing: below 1e-9 of the tone after 14 s.

    Rounding leaves 2e-12; after 4 s the plant's own modes still ring at 2e-8. So what the oracle leaves on measured
    noise is the noise, and to be near to it means something.
    """
    case = asp.steady(1, 70.0)
    y_open = plant.open_loop(case.disturbance(), 0.0)[:, None]
    late = asp.oracle(plant, y_open, [case])[-800:]
    assert np.abs(late).max() < 1e-9 * np.abs(y_open).max()


@pytest.mark.parametrize('model', ['exact', 'identified'])
def test_steady_tones_are_within_half_a_decibel_of_the_oracle(plant, model):
    """Truth: the oracle on the same measured noise. One setting for one, two and three tones; GA and DA 0.5 dB.

    With the exact model the amplification elsewhere, MA, is the oracle's too, and no limit is left that it keeps.
    """
    cases = [asp.steady(1, 60.0), asp.steady(2, 55.0, 75.0), asp.steady(3, 55.0, 70.0, 85.0)]
    trials = bench.Trials(plant, getattr(bench, model)(plant), cases, [[0, 1]] * 3)
    for row in bench.steady_table(trials):
        assert row['ga_behind'] < 0.5
        assert row['da_behind'] < 0.5
        assert row['outside'] == 0
        if model == 'exact':
            assert row['ma_behind'] < 0.5


def test_jumps_are_settled_and_peaks_stay_below_twice_the_open_loop(plant):
    """Truth: a voltage for the tone before the jump at worst adds to the tone after it, so twice the open loop.

    Settled: twice the noise's RMS over 50 ms for good, within a second.
    """
    cases = [asp.steps(1, 75.0, jump=10.0), asp.steps(2, 55.0, 75.0, jump=5.0)]
    trials = bench.Trials(plant, bench.exact(plant), cases, [[0, 1]] * 2)
    for row in bench.step_table(trials):
        assert row['peak'] < 2.0 * row['peak_open']
        assert row['settling_worst'] < 1.0


def test_chirps_leave_little_more_than_the_noise(plant):
    """Truth: RMS of the noise alone and of 0 V on the same segment, while the frequency moves by 10 Hz/s; 2 dB."""
    trials = bench.Trials(plant, bench.exact(plant), [asp.chirp()], [[0]])
    for row in bench.chirp_table(trials):
        assert row['rms_law'] < 10.0 ** (2.0 / 20.0) * row['rms_noise']
        assert row['rms_law'] < 0.2 * row['rms_open']


@pytest.mark.long
def test_the_whole_benchmark():
    """Truth: the oracle. 120 runs, 480 figures: 0.5 dB, and at most the one limit missed that the page tells of."""
    tables = bench.run(5, 20)
    rows = [*tables['steady'], *tables['random']]
    for key in ('ga_behind', 'da_behind', 'ma_behind'):
        assert max(row[key] for row in rows) < 0.5
    assert sum(row['outside'] for row in rows) <= 1
