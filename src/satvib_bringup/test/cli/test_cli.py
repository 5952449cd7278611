# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The satvib command: what it prints, what it leaves, and its exit codes."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from satvib_experiment.report import drawing
from satvib_ident.models.model_file import load_model

DATA = Path(__file__).resolve().parents[4].parent / 'shared' / 'data'
ROBOT = DATA / 'robot_arm' / 'robot_arm.csv'


def refused(result, *told):
    """One line on standard error that holds all of `told`, and exit code 2."""
    code, _, err = result
    assert code == 2
    assert err.startswith('satvib: ')
    assert err.count('\n') == 1
    for text in told:
        assert text in err


def test_help_names_every_command(satvib):
    """Truth: the list of the commands."""
    code, out, _ = satvib('--help')
    assert code == 0
    for name in (
        'demo',
        'run',
        'simulate',
        'report',
        'identify',
        'study',
        'table',
        'call',
        'scenarios',
        'rigs',
    ):
        assert name in out


def test_listings(satvib):
    """Truth: names that the documentation uses."""
    assert 'paper_3dof' in satvib('scenarios')[1]
    assert 'soft_3dof' in satvib('rigs')[1]


@pytest.mark.parametrize('arguments', [('--help',), ('scenarios',), ('rigs',)])
def test_what_only_lists_imports_no_numerical_library(arguments):
    """Truth: the libraries whose import takes most of a second or more, and the modules that were imported.

    A rig is checked before it is listed, and the geometry of listed struts needs NumPy.
    """
    command = [sys.executable, '-X', 'importtime', '-m', 'satvib_bringup.cli.main', *arguments]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    imported = {line.rpartition('|')[2].strip() for line in ended.stderr.splitlines()}
    assert 'satvib_bringup.cli.commands.listing' in imported
    assert not imported & {'scipy', 'numba', 'matplotlib', 'rclpy', 'pyarrow'}
    assert ('numpy' in imported) == (arguments == ('rigs',))


@pytest.mark.usefixtures('no_figures')
def test_a_run_that_controlled_nothing_is_no_success(satvib, tmp_path):
    """Truth: without excitation no model is trusted, and narrowband gives 0 V without one."""
    weak = ['--set', 'controller.law=narrowband', '--set', 'controller.excitation_amplitude=1e-6']
    code, out, _ = satvib('simulate', 'quick_3dof', *weak, '--folder', 'run')
    assert code == 3
    results = [line for line in out.splitlines() if 'dB' in line or 'NO RESULT' in line]
    assert any('NO RESULT: No strut has a model' in line for line in results)
    assert json.loads((tmp_path / 'run' / 'result.json').read_text())['shortfalls']
    assert 'This run is no result' in (tmp_path / 'run' / 'report.html').read_text()


def test_simulate_then_report(satvib, tmp_path, monkeypatch):
    """Truth: the files that the command promises; the second run gets a folder of its own; the report of the first
    one, made again, has the same figures.
    """
    code, out, err = satvib('simulate', 'quick_3dof', '--set', 'seed=3')
    assert code == 0, err
    first = tmp_path / 'runs' / 'quick_3dof-001'
    for name in ('recording.npz', 'scenario.yaml', 'report.html', 'result.json', 'figures'):
        assert (first / name).exists()
    assert 'attenuation in dB' in out
    assert 'simulate quick_3dof: CONTROL' in out
    result = json.loads((first / 'result.json').read_text())
    assert result['seed'] == 3
    monkeypatch.setattr(drawing, 'FIGURES', ())  # they were drawn above, and are no result
    monkeypatch.setattr(drawing, 'MOST', 0)
    code, _, err = satvib('report', first, '--output', tmp_path / 'again')
    assert code == 0, err
    again = json.loads((tmp_path / 'again' / 'result.json').read_text())
    assert again == result


@pytest.mark.usefixtures('no_figures')
def test_the_written_scenario_is_the_one_that_ran(satvib, tmp_path):
    """Truth: a run from the scenario.yaml of a run gives the same result."""
    satvib('simulate', 'quick_3dof', '--set', 'rig.payload.mass=10', '--folder', 'one')
    satvib('simulate', tmp_path / 'one' / 'scenario.yaml', '--folder', 'two')
    one, two = (json.loads((tmp_path / n / 'result.json').read_text()) for n in ('one', 'two'))
    assert one == two
    assert one['rig']['payload']['mass'] == 10.0


def test_an_existing_folder_is_left_alone(satvib, tmp_path):
    """Truth: what was in it."""
    (tmp_path / 'mine').mkdir()
    (tmp_path / 'mine' / 'note.txt').write_text('dear to me')
    refused(satvib('simulate', 'quick_3dof', '--folder', 'mine'), 'mine', 'nothing is overwritten')
    assert [p.name for p in (tmp_path / 'mine').iterdir()] == ['note.txt']
    refused(satvib('run', 'quick_3dof', '--record', 'mine'), 'mine', 'nothing is overwritten')
    assert [p.name for p in (tmp_path / 'mine').iterdir()] == ['note.txt']


def test_bad_input_is_one_line_and_exit_2(satvib, tmp_path):
    """Truth: the messages written by hand; nothing is left behind."""
    refused(satvib('simulate', 'paper_3df'), 'did you mean paper_3dof')
    refused(satvib('run', 'paper_3df'), 'did you mean paper_3dof')
    refused(satvib('simulate', 'quick_3dof', '--set', 'contoller.law=off'), 'controller?')
    refused(satvib('simulate', 'quick_3dof', '--set', 'rig.payload.mass=0'), 'payload.mass')
    refused(satvib('run', 'quick_3dof', '--set', 'rig.acquisition.sample_rate=0'), 'sample_rate')
    refused(satvib('report', tmp_path / 'nothing'), 'nothing: no such file or folder')
    refused(satvib('report', tmp_path), 'not a bag')
    assert list(tmp_path.iterdir()) == []
    (tmp_path / 'runs').write_text('a file in the way')
    refused(satvib('simulate', 'quick_3dof'), 'runs', 'cannot be kept there')
    refused(satvib('simulate', 'quick_3dof', '--folder', 'runs/x'), 'cannot be made')


@pytest.mark.skipif(not ROBOT.is_file(), reason='the measured records are not here')
@pytest.mark.parametrize(
    ('order', 'fit', 'exit_code'), [(2, '0.9085', 3), (4, '0.9967', 0), (6, '0.9986', 0)]
)
def test_identify_the_robot_arm(satvib, tmp_path, order, fit, exit_code):
    """Truth: batch least squares, from the data's own page, four digits; two poles run free with a fit of 0.12, so that
    model is not to be trusted.
    """
    code, out, err = satvib(
        'identify', ROBOT, '--input', 'torque', '--output', 'acceleration', '--order', order,
        '--save', 'model.yaml',
    )  # fmt: skip
    assert code == exit_code, err
    assert f'one step {fit}' in out
    assert (tmp_path / 'model.yaml').is_file()


@pytest.mark.skipif(not ROBOT.is_file(), reason='the measured records are not here')
def test_identify_compares_orders_and_says_why(satvib, tmp_path):
    """Truth: every order asked for is listed; the saved model is that of the order said to be chosen."""
    code, out, err = satvib(
        'identify', ROBOT, '--input', 'torque', '--output', 'acceleration', '--order', 2,
        '--order', 4, '--order', 6, '--save', 'model.yaml', '--plots', 'plots',
    )  # fmt: skip
    assert code == 0, err
    for order in ('2/3', '4/5', '6/7'):
        assert order in out
    chosen = re.search(r'order (\d)/\d: ', out)[1]
    assert load_model(tmp_path / 'model.yaml').order == int(chosen)
    assert len(list((tmp_path / 'plots').glob('*.png'))) == 4
    refused(
        satvib('identify', ROBOT, '--input', 'torque', '--output', 'acceleration', '--save',
               'model.yaml'),
        'model.yaml: exists already',
    )  # fmt: skip


def test_identify_a_strut_of_a_run(satvib, quick_run, tmp_path):
    """Truth: the strut's own identifier on the same samples: least squares from the same data, so a and b agree with
    what was recorded at the end of IDENTIFY to 1e-6 (the live estimate begins with the voltage's first step, the
    offline one with the first sample of the phase; before the step there is noise alone).
    """
    quick_run.save(tmp_path / 'recording.npz')
    code, _, err = satvib('identify', tmp_path / 'recording.npz', '--strut', 2, '--order', 2,
                          '--save', 'model.yaml')  # fmt: skip
    assert code == 0, err
    model = load_model(tmp_path / 'model.yaml')
    assert model.delay == 1
    row = quick_run.window(0.0, 1.5).stop - 1
    np.testing.assert_allclose(model.a, quick_run.get('model', 'a')[row, 1], atol=0.02)
    np.testing.assert_allclose(model.b, quick_run.get('model', 'b')[row, 1], atol=0.02)
    refused(satvib('identify', tmp_path / 'recording.npz', '--strut', 4), '--strut: 4')


def test_the_study_of_signals_leaves_table_and_figures(satvib, tmp_path):
    """Truth: one row per signal and case; names of the figures."""
    code, out, err = satvib('study', '--set', 'seeds=2', '--folder', 'study')
    assert code == 0, err
    lines = (tmp_path / 'study' / 'study.md').read_text().splitlines()
    assert len([line for line in lines if '| PRBS |' in line]) == 4
    assert len(list((tmp_path / 'study').glob('*.png'))) == 5
    assert 'PRBS' in out
    refused(satvib('study', '--set', 'sids=2'), 'did you mean seeds?')


def test_a_bad_csv_is_one_line_and_exit_2(satvib, tmp_path):
    """Truth: by hand; the line numbers count the header as line 1."""
    path = tmp_path / 'record.csv'

    def identify(text):
        path.write_text(text)
        return satvib('identify', path, '--input', 'u', '--output', 'y')

    refused(identify(''), 'record.csv: is empty')
    refused(identify('u,y\n'), 'no data')
    refused(identify('u,z\n1,2\n'), "no column 'y'", 'known: u, z')
    refused(identify('u,y\n1,2\n3,four\n'), 'line 3', "'four', not a number")
    refused(identify('u,y\n1,2\n3\n'), 'line 3', 'the row has 1 cells, the header 2')
    refused(identify('u,y\n1,nan\n'), '1 of 1 rows lack a value')
    refused(identify('u,y\n1,2\n2,3\n'), 'too few')
    refused(satvib('identify', path), 'name the columns')
    refused(identify('u,y\n' + '1,2\n' * 50), 'never changes')
    refused(satvib('identify', tmp_path / 'no.csv', '--input', 'u', '--output', 'y'), 'no.csv')
    path.write_bytes(b'\xff\xfe\x00\x01')
    refused(satvib('identify', path, '--input', 'u', '--output', 'y'), 'no data')


def test_the_table_of_the_demo_shows_what_the_paper_reports_beside_what_is_reached(capsys):
    """Truth: the row that goes in."""
    from satvib_bringup.cli.console import make_console, show_comparison

    row = {
        'scenario': 'paper_3dof', 'rate': 100.0, 'hold': 'zero', 'law': 'model_reference',
        'attenuation': {'measured_tone': -4.4, 'true_tone': -4.9, 'true_rms': None},
        'paper': (-23.35, -29.28),
    }  # fmt: skip
    show_comparison(make_console(), {'shortfalls': [], 'notes': ['a note'], 'comparison': [row]})
    out = capsys.readouterr().out
    for words in (
        "model_reference, the paper's",
        '100 Hz, steps',
        '-4.4',
        '-4.9',
        '-23.4 to -29.3',
        'a note',
    ):
        assert words in out
