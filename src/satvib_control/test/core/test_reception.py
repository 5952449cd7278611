# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What samples say of the voltages before them."""

import math
from types import SimpleNamespace

import pytest
from satvib_common.struts.applied import Applied
from satvib_control.core.reception import received_of


def sample(applied=3.0, state=Applied.APPLIED):
    return SimpleNamespace(applied=applied, applied_state=state)


def test_what_the_coils_got():
    """Truth: by hand, one strut and two."""
    assert float(received_of([sample()], ()).voltage) == 3.0
    found = received_of([sample(), sample(0.0, Applied.SILENT)], (2,))
    assert found.voltage.tolist() == [3.0, 0.0]
    assert found.changed.tolist() == [False, True]
    assert found.withheld.tolist() == [False, True]


@pytest.mark.parametrize('strange', [
    {'state': Applied.UNKNOWN}, {'state': 7}, {'state': 255}, {'applied': math.nan}, {'applied': math.inf},
    {'applied': -1e300},
])  # fmt: skip
def test_numbers_that_no_source_gives_say_nothing(strange):
    """Truth: as if the source of the samples did not say it."""
    assert received_of([sample(**strange)], ()) is None
    assert received_of([sample(), sample(**strange)], (2,)) is None
