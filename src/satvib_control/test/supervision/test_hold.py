# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A hold fades to 0 V, comes back, and ends by itself. Truth: the times of the module."""

import numpy as np
from satvib_control.supervision.hold import FADE_TIME, LONGEST_HOLD, RETURN_TIME, Hold

DT = 0.01


def shares(hold, count):
    return np.array([hold.step() for _ in range(count)])


def test_fade_and_return():
    """Truth: linear in 0.1 s and 0.3 s; an item that is not held stays at 1."""
    hold = Hold(DT, (2,))
    hold.begin(np.array([True, False]))
    found = shares(hold, round(FADE_TIME / DT))
    np.testing.assert_allclose(found[:, 0], np.linspace(0.9, 0.0, 10), atol=1e-12)
    assert np.all(found[:, 1] == 1.0)
    hold.end()
    found = shares(hold, round(RETURN_TIME / DT) + 1)
    np.testing.assert_allclose(found[-1], 1.0, atol=1e-12)
    assert not hold.busy


def test_it_ends_by_itself():
    """Truth: 20 s after it was asked for."""
    hold = Hold(DT, ())
    hold.begin()
    found = shares(hold, round((LONGEST_HOLD + RETURN_TIME) / DT) + 2)
    assert found[round(LONGEST_HOLD / DT) - 2] == 0.0
    assert found[-1] == 1.0
