# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The faults of `faults`, played one after the other on one graph that runs on."""

import pytest
from faults import CHAPTERS, ENDINGS, GOES_ON, QUICK
from play import Scene
from satvib_common.phases import Phase

EARLY = (Phase.STANDBY, Phase.CALIBRATE, Phase.IDENTIFY)


def check(scene, faults):
    """Play faults on a scene, and end it."""
    broken = {}
    for i, fault in enumerate(faults):
        outcome = scene.play(fault, i)
        print(fault.name, outcome, flush=True)
        broken[fault.name] = outcome.broken
    broken['the end'] = scene.end().broken
    assert {name: what for name, what in broken.items() if what} == {}


def test_some_faults(start, probe):
    """Truth: the list, which says what must become of the voltage and within which time, counted in samples.

    A busy machine is away now and then. So many samples more are allowed as the samples and the voltages of the same
    moment were heard too late.
    """
    check(Scene(start, probe), [fault for fault in GOES_ON if fault.name in QUICK])


@pytest.mark.long
@pytest.mark.timeout(600)
@pytest.mark.parametrize(
    'chapter', [name for name, faults in CHAPTERS.items() if faults is not ENDINGS]
)
def test_every_fault_in_control(start, probe, chapter):
    """Truth: the list, as above."""
    faults = [fault for fault in CHAPTERS[chapter] if Phase.CONTROL in fault.phases]
    if faults:
        check(Scene(start, probe), faults)


@pytest.mark.long
@pytest.mark.timeout(600)
@pytest.mark.parametrize('phase', EARLY, ids=lambda phase: phase.name)
def test_every_fault_in_other_phases(start, probe, phase):
    """Truth: the list, as above."""
    check(Scene(start, probe, phase), [fault for fault in GOES_ON if phase in fault.phases])


@pytest.mark.long
@pytest.mark.parametrize('ending', ENDINGS, ids=lambda ending: ending.name)
def test_faults_that_end_the_graph(start, probe, ending):
    """Truth: exit codes, the plant's last line, and the bag."""
    assert Scene(start, probe).end(ending).broken == []
