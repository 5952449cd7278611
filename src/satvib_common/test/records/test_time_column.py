# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a time column says: the places of the samples, the sample period, and what is refused.

Truth everywhere: the places and the period with which the times were made.
"""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.records.record import column_record
from satvib_common.records.time_column import places, unit_of

N = 400
GENERATOR = np.random.default_rng([3])
VALUES = GENERATOR.normal(size=(2, N))


def find(time, values=None, unknown=50):
    values = GENERATOR.normal(size=(2, len(time))) if values is None else values
    return places(np.asarray(time, dtype=float), values, np.arange(len(time)) + 2.0, unknown, 't')


@pytest.mark.parametrize('period', [0.01, 1e-6, 1.0, 1 / 3, 0.0025])
@pytest.mark.parametrize('start', [0.0, 1.7e9])
def test_an_even_time_is_one_sample_a_row(period, start):
    if period < 1e-5 and start:
        pytest.skip('the numbers of a computer cannot hold such times')
    found = find(start + period * np.arange(N))
    assert found.place.tolist() == list(range(N))
    assert found.period == pytest.approx(period, rel=1e-3 if start else 1e-9)
    assert found.notes == []


@pytest.mark.parametrize(
    'kept', [lambda k: k % 10 != 7, lambda k: (k < 50) | (k >= 53), lambda k: k % 37 != 5]
)
def test_missing_samples_leave_their_places_empty(kept):
    """The places of the rows that are left are their own numbers."""
    k = np.flatnonzero(kept(np.arange(N)))
    found = find(0.01 * k)
    assert found.place.tolist() == (k - k[0]).tolist()
    assert found.period == pytest.approx(0.01, rel=1e-9)
    assert f'({N - len(k)} samples' in found.notes[0]


def test_two_samples_a_hundredth_and_three_in_turn_is_a_period_between():
    """400 Hz in whole milliseconds: steps of 2 and 3."""
    found = find(np.rint(2.5 * np.arange(N)))
    assert found.place.tolist() == list(range(N))
    assert found.period == pytest.approx(2.5, rel=0.01)


def test_a_time_rounded_to_more_than_its_period():
    """1 kHz in hundredths of a second: ten rows of one time."""
    found = find(np.floor(0.1 * np.arange(N)) / 100.0)
    assert found.place.tolist() == list(range(N))
    assert found.period == pytest.approx(0.001, rel=0.03)
    assert 'rounded' in found.notes[0]


def test_jitter_is_said():
    found = find(0.01 * (np.arange(N) + 0.05 * GENERATOR.normal(size=N)))
    assert found.place.tolist() == list(range(N))
    assert 'varies by' in found.notes[0]


def test_rows_written_twice_are_left_out():
    k = np.sort(np.concatenate([np.arange(N), [10, 11, 200]]))
    found = find(0.01 * k, VALUES[:, k])
    assert found.size == N
    assert np.sum(found.place == -1) == 3
    assert '3 rows repeat the time' in found.notes[0]
    assert '0 of them with other values' in found.notes[0]


@pytest.mark.parametrize('second', [0.0, 1.0, 1e6])
def test_two_records_glued_are_parted(second):
    """As many places stay empty between them as a model can look back, whether time goes back or jumps."""
    time = np.concatenate([0.01 * np.arange(200), second + 0.01 * np.arange(200)])
    found = find(time + 0.003 * (np.arange(N) >= 200))
    assert np.diff(found.place)[199] == 51
    assert np.sum(np.diff(found.place) == 1) == N - 2
    assert 'line 202' in ' '.join(found.notes)


@pytest.mark.parametrize(
    ('time', 'message'),
    [
        (-0.01 * np.arange(N), 'never goes forward'),
        (np.zeros(N), 'never goes forward'),
        (np.full(N, np.nan), 'fewer than three'),
        (np.cumsum(np.where(np.arange(N) % 5, -1.0, 0.5)), 'runs backward'),
        (0.01 * GENERATOR.permutation(N), 'goes back|runs backward'),
        (np.cumsum(GENERATOR.exponential(size=N)), 'no multiple|missing'),
        (0.01 * np.flatnonzero(np.arange(N) % 3), 'missing after'),
        (np.concatenate([0.01 * np.arange(200), 2.0 + 0.02 * np.arange(200)]), 'missing after'),
        (
            0.01 * np.concatenate([np.arange(100), np.full(60, 99), np.arange(100, 340)]),
            'have the time of the row before',
        ),
    ],
)
def test_a_time_that_is_none_is_refused(time, message):
    with pytest.raises(SatvibError, match=message):
        find(time)


@pytest.mark.parametrize(
    ('name', 'unit'),
    [
        ('Time (ms)', 1e-3),
        ('t[us]', 1e-6),
        ('time_s', 1.0),
        ('Zeit / min', 60.0),
        ('t', None),
        ('seconds', 1.0),
    ],
)
def test_units_in_names(name, unit):
    assert unit_of(name) == unit


def record(tmp_path, header, times, extra=(), **options):
    rows = [f'{t},{u:.6f},{y:.6f}' for t, (u, y) in zip(times, VALUES.T, strict=False)]
    for place, row in extra:
        rows.insert(place, row)
    path = tmp_path / 'r.csv'
    path.write_text('\n'.join([header, *rows, '']))
    return column_record(path, 'u', 'y', **options)


def test_the_sample_period_comes_from_the_time(tmp_path):
    k = np.arange(N)
    assert record(tmp_path, 'time (ms),u,y', 2 * k).dt == pytest.approx(0.002)
    assert record(tmp_path, 't,u,y', 0.5 * k).dt == pytest.approx(0.5)
    assert record(tmp_path, 'x,u,y', 0.5 * k).dt == 1.0
    assert record(tmp_path, 'x,u,y', 0.5 * k, time='x').dt == pytest.approx(0.5)
    assert record(tmp_path, 'x,u,y', 0.5 * k, time='1').dt == pytest.approx(0.5)
    told = record(tmp_path, 't,u,y', 0.5 * k, period=0.1)
    assert told.dt == 0.1
    assert any('advances by 0.5 s, --sample-period is 0.1 s' in note for note in told.notes)
    clock = [f'12:{i // 600:02d}:{i % 600 / 10:04.1f}' for i in range(N)]
    assert record(tmp_path, 'Time,u,y', clock).dt == pytest.approx(0.1)


def test_blank_rows_and_repeated_headers_are_gaps(tmp_path):
    blank = record(tmp_path, 'x,u,y', range(N), extra=[(100, ''), (200, ',,')])
    assert np.flatnonzero(np.isnan(blank.y)).tolist() == [100, 200]
    glued = record(tmp_path, 'x,u,y', range(N), extra=[(100, 'x,u,y')], memory=30)
    assert np.flatnonzero(np.isnan(glued.y)).tolist() == list(range(100, 131))
    assert any('header is repeated at line 102' in note for note in glued.notes)


def test_lines_that_are_blank_in_turn_are_no_gaps(tmp_path):
    found = record(tmp_path, 'x,u,y', range(N), extra=[(2 * i + 1, '') for i in range(N - 1)])
    np.testing.assert_allclose(found.y, VALUES[1], atol=1e-6)
