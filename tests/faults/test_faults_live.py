# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The faults of `faults`, played one after the other on one graph that runs on."""

import pytest
from faults import CLOCKS, ENDINGS, MESSAGES, PROCESSES, SENSORS, STRANGERS
from play import Scene


# on a machine that cannot keep up with 200 samples a second the plant is behind its clock, and times mean nothing
@pytest.mark.long
@pytest.mark.parametrize(
    ('faults', 'ending'),
    [
        pytest.param((*MESSAGES, *SENSORS, *CLOCKS), None, id='messages'),
        pytest.param((*STRANGERS, *PROCESSES), ENDINGS[0], id='strangers'),
    ],
)
def test_every_fault_of_a_strut(start, probe, faults, ending):
    """Truth: the list, which says what must become of the voltage and within which time, counted in samples."""
    scene = Scene(start, probe)
    broken = {}
    for i, fault in enumerate(faults):
        outcome = scene.play(fault, i)
        print(fault.name, outcome, flush=True)
        broken[fault.name] = outcome.broken
    broken['the end'] = scene.end(ending).broken
    assert {name: what for name, what in broken.items() if what} == {}
