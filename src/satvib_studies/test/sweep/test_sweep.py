# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Studies: every cell a scenario, the rows the same on any number of processes."""

import math
import multiprocessing

import pytest
import yaml
from satvib_common.errors import SatvibError
from satvib_experiment.analysis.analysis import analyse
from satvib_experiment.twin.closed_loop import simulate
from satvib_studies.sweep.figure import draw, shown
from satvib_studies.sweep.sweep import (
    FOLDER,
    SweepFigure,
    load_sweep,
    merged,
    run_sweep,
    sweep_names,
)
from satvib_studies.sweep.tables import COLUMNS, fill, markdown, summary

SMALL = {
    'name': 'small',
    'base': {
        'seed': 3,
        'duration': 2.5,
        'phases': [
            {'phase': 'CALIBRATE'},
            {'phase': 'STANDBY', 'start': 0.5},
            {'phase': 'CONTROL', 'start': 1.0},
        ],
        'analysis': {'controlled': [1.5, 2.5]},
    },
    'axes': {
        'rig': {'stiff': {'rig': 'paper_1dof'}},
        'disturbance': {
            '10 Hz': {
                'disturbance': {'kind': 'sine', 'frequency': 10, 'amplitude': 1, 'start': 0.5}
            }
        },
        'law': {
            'none': {'controller': {'law': 'off'}},
            'velocity': {'controller': {'law': 'velocity_feedback'}},
        },
    },
}


@pytest.fixture
def small(tmp_path):
    path = tmp_path / 'small.yaml'
    path.write_text(yaml.safe_dump(SMALL, sort_keys=False))
    return path


def test_rows_are_those_of_single_runs_on_any_number_of_processes(small):
    """Truth: each cell simulated and analysed by hand; no tolerance. Processes that die cost no row."""
    cells = load_sweep(small).cells()
    alone = dict(run_sweep(cells, jobs=1))
    together = {}
    for index, row in run_sweep(cells, jobs=2):
        together[index] = row
        for process in (
            multiprocessing.active_children()
        ):  # the first row is there, the second may have to begin again
            process.kill()
    assert together == alone
    for index, cell in enumerate(cells):
        e, _ = analyse(simulate(cell.scenario))
        assert alone[index]['struts']['true_rms'] == list(e.attenuation_open_loop['true_rms'])
    assert alone[0]['worst']['true_rms'] == pytest.approx(0.0, abs=1e-12)
    assert alone[1]['worst']['true_rms'] < -1.0


def test_the_table_shows_every_cell(small):
    """Truth: by hand: one table per rig, one line per cell, the worst strut's figures."""
    rows = [row for _, row in sorted(run_sweep(load_sweep(small).cells(), jobs=1))]
    text = markdown(rows)
    lines = [line for line in text.splitlines() if line.startswith('| 10 Hz')]
    assert text.startswith('### stiff\n')
    assert len(lines) == 2
    assert all(line.count('|') == len(COLUMNS) + 3 for line in lines)
    assert f'{rows[1]["worst"]["true_rms"]:+.1f}' in lines[1]


def test_overrides_reach_the_base(small):
    """Truth: the values given."""
    sweep = load_sweep(small, ['base.seed=9', 'axes.law.velocity.controller.velocity_gain=20'])
    cell = sweep.cells()[1]
    assert cell.scenario.seed == 9
    assert cell.scenario.controller['velocity_gain'] == 20


@pytest.mark.parametrize('name', sweep_names())
def test_every_sweep_of_the_package_is_made_of_scenarios(name):
    """Truth: the product of its axes."""
    sweep = load_sweep(name)
    axes = yaml.safe_load((FOLDER / f'{name}.yaml').read_text())['axes']
    assert len(sweep.cells()) == math.prod(len(axis) for axis in axes.values())


@pytest.mark.parametrize(
    ('override', 'told'),
    [
        ('axis={}', 'axis: no such key; did you mean axes?'),
        ('axes={}', 'axes: at least one is needed'),
        ('axes.rig=3', 'axes.rig: a mapping of labels'),
        ('axes.rig.stiff=3', 'axes.rig.stiff: a mapping of keys'),
        ('axes.rig.stiff.rig=none_such', 'no such rig'),
        ('axes.law.velocity.controller.law=magic', "'magic' is not one of"),
        ('axes.disturbance.10 Hz.disturbance.kind=quake', "'quake'"),
        ('base.durration=3', 'durration: no such key; did you mean duration?'),
    ],
)
def test_a_wrong_sweep_is_named(small, override, told):
    """Truth: by hand; one line."""
    with pytest.raises(SatvibError) as caught:
        load_sweep(small, [override]).cells()
    assert told in str(caught.value)
    assert '\n' not in str(caught.value)
    with pytest.raises(SatvibError, match='did you mean laws'):
        load_sweep('lawz')


def test_later_axes_win_and_nested_keys_are_merged():
    """Truth: by hand."""
    below = {'a': {'x': 1, 'y': 2}, 'b': 3}
    assert merged(below, {'a': {'y': 5}, 'b': {'z': 1}}) == {'a': {'x': 1, 'y': 5}, 'b': {'z': 1}}
    assert below == {'a': {'x': 1, 'y': 2}, 'b': 3}


def test_the_figure_leaves_out_laws_that_refused(tmp_path):
    """Truth: by hand: a refused cell has no point, and a figure without any row is not drawn."""
    what = SweepFigure.from_mapping({'x': 'a', 'panel': 'b', 'line': 'c', 'fixed': {'d': 'k'}})
    kinds = ('measured_rms', 'true_rms', 'measured_tone', 'true_tone')
    row = {
        'labels': {'a': '1', 'b': 'x', 'c': 'y', 'd': 'k'},
        'worst': dict.fromkeys(kinds, -3.0),
        'reasons': [],
    }
    assert shown(row, 'true_rms') == -3.0
    assert math.isnan(shown({**row, 'reasons': ['refused']}, 'true_rms'))
    assert draw([row], what, tmp_path / 'figure.png')
    assert (tmp_path / 'figure.png').read_bytes().startswith(b'\x89PNG')
    other = {**row, 'labels': {**row['labels'], 'd': 'else'}}
    assert not draw([other], what, tmp_path / 'none.png')
    assert not (tmp_path / 'none.png').exists()


def test_a_figure_of_an_axis_that_is_not_there_is_named(small):
    """Truth: by hand."""
    with pytest.raises(SatvibError, match="no axis 'rug'; did you mean rig"):
        load_sweep(small, ['figure={x: rug, panel: law, line: law}'])


def test_exceptions_are_for_cells_with_all_of_their_labels(small):
    """Truth: by hand: one of two cells has the seed of the exception; what is not there is named."""
    exception = 'exceptions=[{labels: {rig: stiff, law: velocity}, keys: {seed: 8}}]'
    assert [cell.scenario.seed for cell in load_sweep(small, [exception]).cells()] == [3, 8]
    with pytest.raises(SatvibError, match="exceptions: no axis 'lav'; did you mean law"):
        load_sweep(small, ['exceptions=[{labels: {lav: velocity}, keys: {}}]'])
    with pytest.raises(SatvibError, match="axis law has no label 'velocty'; did you mean velocity"):
        load_sweep(small, ['exceptions=[{labels: {law: velocty}, keys: {}}]'])


def test_a_page_gets_its_tables_between_its_marks(small, tmp_path):
    """Truth: by hand: what stood between the marks is gone, the rest stays; a page without marks is left alone."""
    sweep = load_sweep(small, ['summary={row: law, column: rig, fixed: {disturbance: 10 Hz}}'])
    rows = [row for _, row in sorted(run_sweep(sweep.cells(), jobs=1))]
    short = summary(rows, sweep.summary)
    assert short.splitlines()[0] == '| law | stiff |'
    assert short.splitlines()[2] == '| none | 0 V |'
    figures = rows[1]['worst']
    for kind in ('measured_tone', 'true_tone', 'true_rms'):
        assert f'{figures[kind]:+.1f}' in short.splitlines()[3]
    page = tmp_path / 'page.md'
    page.write_text('a\n<!-- summary small -->\nold\n<!-- end -->\nb\n')
    assert fill(page, {'table small': 'unused', 'summary small': short}) == 1
    assert page.read_text() == f'a\n<!-- summary small -->\n{short}<!-- end -->\nb\n'
    page.write_text('nothing\n')
    with pytest.raises(SatvibError, match='no mark <!-- table small -->'):
        fill(page, {'table small': short})
    assert page.read_text() == 'nothing\n'
    with pytest.raises(SatvibError, match='cannot be read'):
        fill(tmp_path / 'none.md', {'table small': short})
