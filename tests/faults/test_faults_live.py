# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The faults of `faults`, played one after the other on one graph that runs on."""

import pytest
from faults import ENDINGS, GOES_ON
from play import Scene


@pytest.mark.parametrize(
    'ending',
    [ENDINGS[0], *(pytest.param(ending, marks=pytest.mark.long) for ending in ENDINGS[1:])],
    ids=lambda ending: ending.name,
)
def test_every_fault_of_a_strut(start, probe, ending):
    """Truth: the list, which says what must become of the voltage and within which time, counted in samples."""
    scene = Scene(start, probe)
    broken = {}
    for i, fault in enumerate(GOES_ON):
        outcome = scene.play(fault, i)
        print(fault.name, outcome, flush=True)
        broken[fault.name] = outcome.broken
    broken[ending.name] = scene.end(ending).broken
    assert {name: what for name, what in broken.items() if what} == {}
