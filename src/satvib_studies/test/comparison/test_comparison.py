# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The comparison: its cells are scenarios, its figures are those of single runs, its words hold."""

import json
from pathlib import Path

import numpy as np
import pytest
from satvib_bringup.cli import main as cli
from satvib_common.errors import SatvibError
from satvib_common.struts.motions import mode_matrix
from satvib_experiment.recording.run_folder import write_scenario
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop, simulate
from satvib_plant_sim.rig.rig import load_rig
from satvib_studies.comparison.cases import OPEN, drawn_rig, load_comparison, replayable
from satvib_studies.comparison.runs import run_comparison
from satvib_studies.comparison.tables import attenuation_table, plain, tables

# ten seconds in place of thirty: enough for what must hold
SHORT = [
    'seeds=2', 'base.duration=10', 'event=6.5',
    'windows={before: [6.0, 6.5], after: [6.5, 8.0], settled: [9.0, 10.0]}',
    # the open loop is heard before CONTROL, as in the whole comparison
    (
        'base.phases=[{phase: CALIBRATE}, {phase: IDENTIFY, start: 0.5}, {phase: STANDBY, start: 3.5}, '
        '{phase: CONTROL, start: 5}]'
    ),
    'base.disturbance={kind: sine, frequency: 9.0, amplitude: 0.5, start: 3.5}',
]  # fmt: skip


@pytest.fixture(scope='module')
def found():
    whole = load_comparison(None, SHORT)
    kept = ('nominal', 'lighter_anew', 'actuator', 'sensor', 'controller', 'random', 'noise')
    return run_comparison(whole.replace(cases={name: whole.cases[name] for name in kept}))


def test_a_cell_of_the_batch_is_its_single_run(found):
    """Truth: the scenario alone, with the rig of its seed, through the same sums; bit for bit."""
    c = found.comparison
    cases = list(c.cases)
    for scheme, case, i in (('adaptive', 'actuator', 1), ('centralized', 'sensor', 0)):
        scenario = c.scenario(scheme, case, c.seed + i)
        loop = ClosedLoop(scenario, [drawn_rig(scenario.load_rig(), scenario.seed)])
        mode = mode_matrix((90.0, 210.0, 330.0))
        for step in loop.steps():
            q = np.einsum('mi,tif->tmf', mode, step.truth.upper[None])
            level = np.mean(q * q, axis=2).sum(axis=1)
            assert level[0] == found.level[scheme][cases.index(case), i, step.sequence]


def test_a_cell_can_be_run_by_itself(found, tmp_path):
    """Truth: the level of the batch, bit for bit, from the cell's own scenario file."""
    c = found.comparison
    write_scenario(replayable(c, 'velocity', 'lighter_anew', c.seed + 1), tmp_path)
    scenario = load_scenario(tmp_path / 'scenario.yaml')
    assert scenario.load_rig() == drawn_rig(
        c.scenario('velocity', 'lighter_anew', c.seed + 1).load_rig(), c.seed + 1
    )
    truth = simulate(scenario).get('truth', 'upper')
    q = np.einsum('mi,tif->tmf', mode_matrix((90.0, 210.0, 330.0)), truth)
    level = np.mean(q * q, axis=2).sum(axis=1)
    assert np.array_equal(level, found.level['velocity'][list(c.cases).index('lighter_anew'), 1])


def test_until_the_event_cases_do_not_differ(found):
    """Truth: the case in which nothing goes wrong, bit for bit, up to the sample of the event."""
    c = found.comparison
    k, cases = round(c.event / found.dt), list(c.cases)
    for scheme in (OPEN, *c.schemes):
        level = found.level[scheme]
        for case, there in c.case_list().items():
            i = cases.index(case)
            same = np.array_equal(level[i, :, :k], level[0, :, :k])
            assert same != bool(there.keys), case
            changed = not np.array_equal(level[i, :, k:], level[0, :, k:])
            quiet = scheme == OPEN and case in {'sensor', 'controller'}
            assert changed == (case != 'nominal' and not quiet) or case == 'actuator', case


def test_what_the_page_says_holds(found):
    """Truth: the numbers themselves, in every seed: what a lost sensor, a lost controller and noise do to whom."""

    def worst(scheme, case, window='settled'):
        return found.attenuation(scheme, case, window).max()

    def best(scheme, case, window='settled'):
        return found.attenuation(scheme, case, window).min()

    # all of the centralized scheme is lost with one sensor or with its controller; two struts of three go on
    for case in ('sensor', 'controller'):
        assert abs(worst('centralized', case)) < 1.0
        assert worst('velocity', case) < -3.0
    # the tone is where adaptation wins, noise where the centralized law does
    assert (
        worst('adaptive', 'nominal') < best('centralized', 'nominal') - 5.0
    )  # 5 s after switching on
    assert worst('centralized', 'random') < worst('adaptive', 'random')


def test_tables_and_numbers_tell_every_cell(found):
    """Counted: a row per case, a column per scheme, a number per seed; JSON takes it."""
    c = found.comparison
    text = attenuation_table(found, 'settled')
    assert text.count('\n') == 2 + len(c.cases)
    for case in c.case_list().values():
        assert f'| {case.title} |' in text
    assert text.count('**') == 2 * len(c.cases)
    names = {'after', 'settled', 'tilts', 'voltages'}
    assert set(tables(found)) == {f'compare {name}' for name in names}
    data = json.loads(json.dumps(plain(found), allow_nan=False))
    for cells in data['cases'].values():
        for scheme in c.schemes:
            assert len(cells[scheme]['settled']) == c.seeds


def test_rigs_of_seeds_are_within_their_tolerances():
    """Truth: the stated tolerances; the same seed is the same rig."""
    rig = load_rig('soft_3dof')
    drawn = [drawn_rig(rig, seed) for seed in range(60)]
    stiff = np.array([d.struts.stiffness_scale for d in drawn]) / rig.struts.stiffness_scale
    force = np.array([d.coil.force_scale for d in drawn])
    assert np.abs(stiff - 1.0).max() <= 0.05
    assert 0.08 < np.abs(force - 1.0).max() <= 0.1
    assert drawn[5] == drawn_rig(rig, 5) != drawn[6]


BAD = {
    'seeds=0': 'seeds: 0 is less than 1',
    'base.rig=nothing': 'comparison schemes: adaptive, nominal:',
    'schemes.adaptive.keys.controller.law=magic': "scenario adaptive-nominal: controller: law: 'magic'",
    'cases.sensor.failures=[{kind: sensor_lost}]': 'cases.sensor: failures[0]: strut: missing',
    'event=40': 'the run ends at 30.0 s',
    'windows.after=[3, 1]': 'windows.after: a start and a later end',
    'case.x=1': 'case: no such key; did you mean cases?',
    'schemes.lqg.keys.centralized.file=none.yaml': 'none.yaml: ',
    'schemes.notch.keys.controller.file=comparison.yaml': 'no gains in it, the key controller is expected',
}


@pytest.mark.parametrize('override', BAD)
def test_bad_input_is_one_line_and_exit_2(override, tmp_path: Path, monkeypatch, capsys):
    """The cell is named, and nothing is written."""
    folder = tmp_path / 'out'
    monkeypatch.setattr(
        'sys.argv', ['satvib', 'compare', '--folder', str(folder), '--set', override]
    )
    with pytest.raises(SystemExit) as ended:
        cli.main()
    error = capsys.readouterr().err
    assert ended.value.code == 2
    assert BAD[override] in error
    assert error.count('\n') == 1
    assert not folder.exists()


def test_the_command_writes_tables_numbers_figure_and_page(tmp_path: Path, monkeypatch, capsys):
    """Truth: the tables printed are those written, also between the marks of a page."""
    page = tmp_path / 'page.md'
    page.write_text('before\n<!-- compare settled -->\nold\n<!-- end -->\nafter\n')
    keep = [f'cases={json.dumps({"nominal": {"title": "nothing"}})}', *SHORT, 'seeds=1']
    arguments = ['satvib', 'compare', '--folder', str(tmp_path / 'out'), '--page', str(page)]
    for setting in keep:
        arguments += ['--set', setting]
    monkeypatch.setattr('sys.argv', arguments)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert not ended.value.code, capsys.readouterr().err
    text = (tmp_path / 'out' / 'tables.md').read_text()
    assert text in capsys.readouterr().out
    assert '| nothing |' in page.read_text()
    assert 'old' not in page.read_text()
    assert (tmp_path / 'out' / 'comparison.png').stat().st_size > 10_000
    json.loads((tmp_path / 'out' / 'comparison.json').read_text())
    load_scenario(tmp_path / 'out/scenarios/adaptive-nominal/scenario.yaml')


def test_a_rig_of_one_strut_has_no_modes_to_compare():
    """Refused by name."""
    one = load_comparison(None, SHORT)
    cases = {'nominal': {'title': 'nothing'}}
    schemes = {'velocity': {'title': 'v', 'keys': {'controller': {'law': 'velocity_feedback'}}}}
    one = one.replace(base={**one.base, 'rig': 'paper_1dof'}, cases=cases, schemes=schemes)
    with pytest.raises(SatvibError, match='the payload of paper_1dof does not tilt'):
        run_comparison(one)


def test_a_comparison_is_called_by_its_name():
    """Truth: its cells are scenarios, the gains that it names are there; a wrong name is one line."""
    six = load_comparison('hexapod')
    assert six.name == 'hexapod'
    assert six.scenario('lqg', 'nominal', 1).load_rig().struts.count == 6
    assert load_comparison('schemes') == load_comparison()
    with pytest.raises(SatvibError, match='did you mean hexapod'):
        load_comparison('hexapd')


def test_gains_of_a_comparison_are_those_of_the_scenario():
    """Truth: both are what one search found."""
    scenario = load_scenario('hexapod_6dof_centralized').centralized
    compared = load_comparison('hexapod').scenario('centralized', 'nominal', 1).centralized
    for name in ('gains_p', 'gains_i', 'gains_d'):
        assert compared[name] == pytest.approx(scenario[name], rel=1e-5)
