# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What `satvib judge` runs."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_experiment.scenario.scenario import load_scenario
from satvib_plant_sim.responses.transmission import transmissibility
from satvib_studies.isolation.cases import OPEN, load_isolation
from satvib_studies.isolation.figure import draw
from satvib_studies.isolation.runs import run_isolation
from satvib_studies.isolation.tables import page_tables, plain, rows_of

SHORT = [
    'seeds=2', 'measurement.duration=9', 'measurement.settle=2', 'frf.resolution=0.5', 'roll_off=[25, 70]',
]  # fmt: skip
RIG, LAW = 'soft_3dof', 'velocity_feedback'


@pytest.fixture(scope='module')
def isolation():
    return load_isolation(None, SHORT)


@pytest.fixture(scope='module')
def found(isolation):
    return {(f.rig, f.law): f for f in run_isolation(isolation, [RIG], [LAW], 1)}


def test_the_open_loop_is_that_of_the_rig(isolation, found):
    """Truth: the rig's exact response, away from the mode, where segments of 2 s have a bias; 0.5 dB."""
    heave = next(c for c in found[RIG, OPEN].curves[0] if c.output == 'strut_2')
    rig = isolation.measured(RIG, OPEN)[0].load_rig()
    f = heave.measured.frequency
    off = heave.measured.decibels - 20.0 * np.log10(np.abs(transmissibility(rig, f)[:, 1]))
    away = (np.abs(f - 9.0) > 3.0) & (f < 60.0)
    assert np.abs(off[away]).max() < 0.5


def test_a_damper_takes_the_peak_and_the_tilt(isolation, found):
    """Truth: velocity feedback has a damping ratio above 0.5 on this rig: no peak above 3 dB where there were 15."""
    rows = rows_of(isolation, found, RIG, [LAW])
    assert rows[OPEN].peak.min() > 15.0
    assert rows[LAW].peak.max() < 3.0
    assert (found[RIG, LAW].sight < 0.5 * found[RIG, OPEN].sight).all()
    assert (found[RIG, OPEN].base_voltage == 0.0).all()
    assert (found[RIG, LAW].base_voltage > 0.0).all()


def test_tables_numbers_and_figure(isolation, found, tmp_path):
    """Truth: a row for each law and the open loop, the marks of the page, every number known or None."""
    made = page_tables(isolation, found, [RIG], [LAW])
    assert set(made) == {f'judge {RIG}', f'judge {RIG}, line of sight'}
    for table in made.values():
        assert sum(row.startswith('|') for row in table.splitlines()) == 4
    numbers = plain(isolation, found, [RIG], [LAW])['rigs'][RIG]
    assert numbers[LAW]['peak'] == rows_of(isolation, found, RIG, [LAW])[LAW].peak.tolist()
    draw(isolation, found, RIG, [LAW], tmp_path / 'figure.png')
    assert (tmp_path / 'figure.png').stat().st_size > 20_000


def test_seeds_differ_in_the_rig_and_laws_do_not(isolation):
    """Truth: the first seed has the rig as it is; each seed has one rig for all laws."""
    one, other = (isolation.wheels(RIG, law) for law in (LAW, OPEN))
    assert one[0].load_rig() == load_scenario('soft_3dof_wheel').load_rig()
    assert one[0].load_rig() != one[1].load_rig()
    assert [s.load_rig() for s in one] == [s.load_rig() for s in other]


def test_every_law_of_every_rig_is_a_scenario():
    """Truth: the check of a scenario; the gains named by files are there."""
    whole = load_isolation(None, ['seeds=1'])
    for rig in whole.rigs:
        for law in (OPEN, *whole.laws):
            assert len(whole.measured(rig, law)) == len(whole.wheels(rig, law)) == 1


@pytest.mark.parametrize(
    ('change', 'said'),
    [
        ('roll_off=[80, 25]', 'roll_off: a frequency and a higher one'),
        (
            'rigs.soft_3dof.laws.nothch={}',
            "rigs.soft_3dof.laws: no law 'nothch'; did you mean notch",
        ),
        ('laws.notch.kind=other', 'kind'),
    ],
)
def test_what_is_wrong_is_named(change, said):
    """Truth: one line that names the key."""
    with pytest.raises(SatvibError) as error:
        load_isolation(None, [change])
    assert said in str(error.value)
    assert '\n' not in str(error.value)


def test_a_rig_of_one_strut_is_refused():
    """It has no motions of the payload, so none of the figures; it ended with a traceback after all runs."""
    case = 'rigs.one={scenario: paper_1dof_10hz, wheel: paper_1dof_10hz}'
    with pytest.raises(SatvibError, match='one, open: paper_1dof has one strut'):
        load_isolation(None, [case, 'seeds=1']).measured('one', OPEN)
