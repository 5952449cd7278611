# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Runs beside one another. Truth: the report of each run on its own, and the scenario files."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.report import drawing
from satvib_experiment.report.build import write_report
from satvib_experiment.report.comparison import BESIDE, KINDS, row_of, simulated_rows
from satvib_experiment.report.drawing import Drawing
from satvib_experiment.scenario.scenario import load_scenario


def test_the_row_of_a_run_is_its_worst_strut(quick_run):
    evaluation = evaluate(quick_run, None)
    row = row_of(quick_run.scenario, evaluation)
    assert (row.scenario, row.rate, row.hold, row.law) == (
        'quick_3dof',
        100.0,
        'zero',
        'model_reference',
    )
    for kind in KINDS:
        assert row.attenuation[kind] == np.max(evaluation.attenuation[kind])


def test_rows_of_other_processes_are_those_of_this_one(quick_run):
    """Truth: the twin in this process, every bit; the seed is among the settings."""
    (row,) = simulated_rows(['quick_3dof'], [f'seed={quick_run.seed}'])
    assert row == row_of(quick_run.scenario, evaluate(quick_run, None))


def test_a_wrong_name_is_one_line_from_another_process_too():
    with pytest.raises(SatvibError, match='no_such_scenario'):
        simulated_rows(['no_such_scenario'])


def test_the_scenarios_beside_the_paper_have_its_disturbance_and_windows():
    """A comparison compares only where disturbance, windows and duration are the same."""
    paper = load_scenario('paper_3dof')
    for name in BESIDE:
        other = load_scenario(name)
        assert other.disturbance == paper.disturbance
        assert other.analysis == paper.analysis
        assert other.duration == paper.duration


def test_report_and_result_show_the_rows(quick_run, tmp_path, monkeypatch):
    monkeypatch.setattr(drawing, 'FIGURES', ())  # the rows are a table
    row = row_of(quick_run.scenario, evaluate(quick_run, None))
    report = write_report(
        quick_run,
        tmp_path / 'report',
        Drawing(0),
        beside=lambda: [row._replace(law='other')],
    )
    assert [shown['law'] for shown in report.result['comparison']] == ['model_reference', 'other']
    page = report.page.read_text()
    assert 'beside others' in page
    assert '<th>other</th>' in page
