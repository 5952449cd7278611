# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The ring of samples behind the page."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_bringup.watch.samples import Column, SampleRing

PLATES = slice(Column.UPPER, Column.LOWER + 1)


def filled(ring: SampleRing, first: int, last: int) -> None:
    """Samples whose upper acceleration is their sequence, and the lower its negative."""
    k = np.arange(first, last)
    ring.put(PLATES, k, np.stack([k, -k], axis=1).astype(float))


def test_blocks_have_the_least_and_largest_value():
    """Truth: the values are the sequences, so block b of 4 runs from 4 b to 4 b + 3; no tolerance."""
    ring = SampleRing(100)
    filled(ring, 0, 40)
    low, high = ring.blocks(2, 10, 4)
    np.testing.assert_array_equal(low[Column.UPPER], 4.0 * np.arange(2, 10))
    np.testing.assert_array_equal(high[Column.UPPER], 4.0 * np.arange(2, 10) + 3.0)
    np.testing.assert_array_equal(low[Column.LOWER], -4.0 * np.arange(2, 10) - 3.0)
    assert np.isnan(low[Column.ASKED]).all()


def test_one_short_peak_is_never_lost():
    """Truth: a single sample of 9 among zeros is the largest value of its block."""
    ring = SampleRing(1000)
    values = np.zeros((1000, 2))
    values[777] = 9.0
    ring.put(PLATES, np.arange(1000), values)
    _, high = ring.blocks(0, 50, 20)
    assert high[Column.UPPER].tolist() == [9.0 if b == 777 // 20 else 0.0 for b in range(50)]


def test_what_is_missing_or_no_longer_kept_is_nan():
    """Truth: samples 10..19 were never put in; of 64 kept samples the newest is 99."""
    ring = SampleRing(64)
    filled(ring, 0, 10)
    filled(ring, 20, 100)
    assert np.isnan(ring.blocks(1, 2, 10)[0][Column.UPPER, 0])
    low, _ = ring.blocks(0, 10, 10)
    assert np.isnan(low[Column.UPPER, :3]).all()  # 0..29 were written over
    assert low[Column.UPPER, 3] == 36.0  # 30..35 were, 36..39 are there
    assert low[Column.UPPER, 9] == 90.0
    assert np.isnan(ring.blocks(10, 12, 10)[0]).all()  # not yet there


def test_a_late_voltage_is_put_where_it_belongs_and_reported():
    """Truth: the sequence of the voltage."""
    ring = SampleRing(64)
    filled(ring, 0, 50)
    ring.changed = 50
    asked = slice(Column.ASKED, Column.ASKED + 1)
    ring.put(asked, np.array([17]), np.array([[2.5]]))
    assert ring.changed == 17
    assert ring.newest(Column.ASKED, 50)[17] == 2.5
    assert np.isnan(np.delete(ring.newest(Column.ASKED, 50), 17)).all()


@settings(deadline=None)
@given(st.lists(st.integers(1, 40), min_size=1, max_size=30), st.integers(8, 64))
def test_any_portions_give_the_same_samples(portions, capacity):
    """Truth: the same samples put in one by one; no tolerance."""
    whole, single = SampleRing(capacity), SampleRing(capacity)
    k = 0
    for portion in portions:
        filled(whole, k, k + portion)
        for j in range(k, k + portion):
            filled(single, j, j + 1)
        k += portion
    for column in (Column.UPPER, Column.LOWER):
        kept = whole.newest(column, capacity)
        np.testing.assert_array_equal(kept, single.newest(column, capacity))
        assert kept[-1] == (k - 1 if column is Column.UPPER else 1 - k)
