# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The figure of an isolator on six struts: its exact response is that of the direction in which the base moved.

Truth: the responses of the rig's plates to a base that moves in that direction.
"""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_allclose
from satvib_experiment.analysis.analysis import analyse
from satvib_experiment.report.context import Context
from satvib_experiment.report.figures.registry import draw_figure
from satvib_experiment.report.judged import judged
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate
from satvib_plant_sim.responses.transmission import plate_responses

SETTINGS = [
    'duration=9', 'phases=[{phase: CALIBRATE}, {phase: STANDBY, start: 1.0}, {phase: CONTROL, start: 5.0}]',
    'controller={law: off}', 'analysis={uncontrolled: [2.0, 5.0], controlled: [6.0, 9.0]}',
]  # fmt: skip
NOISE = {'kind': 'random', 'low': 2.0, 'high': 60.0, 'rms': 0.5, 'start': 1.0}
SIDEWAYS = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
ACROSS = [0, 3]  # struts whose feet do not move along them when the base moves along x


def context_of(run):
    evaluation, open_loop = analyse(run)
    return Context(run, open_loop, evaluation)


@pytest.fixture(scope='module')
def sideways():
    """The base moves along x."""
    scenario = load_scenario('hexapod_6dof', SETTINGS)
    run = simulate(scenario.replace(disturbance=NOISE | {'direction': [-2.0, 0.0, 0.0]}))
    return context_of(run)


@pytest.fixture
def drawn(monkeypatch, tmp_path):
    """A function: draw the figure of a context, and give the dashed lines of its first axes, and its caption."""
    made, real = [], Figure.subplots

    def keep(self, *arguments, **options):
        made.append(real(self, *arguments, **options))
        return made[-1]

    monkeypatch.setattr(Figure, 'subplots', keep)

    def draw(context):
        figure = draw_figure(context, tmp_path, 'isolation')
        lines = made[-1][0, 0].get_lines()
        return [line for line in lines if line.get_linestyle() == '--'], figure.caption

    return draw


def test_the_exact_response_is_that_of_a_base_that_moves_sideways(sideways, drawn):
    lines, caption = drawn(sideways)
    assert len(lines) == 4
    f = lines[0].get_xdata()
    upper, lower = plate_responses(sideways.recording.rig, f, direction=SIDEWAYS)
    for line, strut in zip(lines, sorted({*range(6)} - {*ACROSS}), strict=True):
        exact = 20.0 * np.log10(np.abs(upper[:, strut] / lower[:, strut]))
        assert_allclose(line.get_ydata(), exact, atol=1e-9)
    assert 'with the factors 1 0 0 0 0 0 along' in caption


def test_a_strut_across_the_motion_has_no_largest_transmissibility(sideways):
    """The page has one row for each strut, so the others keep their places."""
    found = judged(sideways)['transmissibility']['uncontrolled']
    assert [i for i, worst in enumerate(found) if worst is None] == ACROSS


@pytest.mark.parametrize(
    ('disturbance', 'why'),
    [
        ({'kind': 'sum', 'terms': [NOISE, NOISE | {'direction': [1.0, 0.0, 0.0]}]}, 'the base moved in 2 directions'),
        (NOISE | {'target': 'payload'}, 'what shook the rig did not move its base'),
        ({}, 'it is not known in which direction the base moved'),
    ],
)  # fmt: skip
def test_no_exact_response_where_the_direction_is_not_one(sideways, drawn, disturbance, why):
    scenario = sideways.recording.scenario.replace(disturbance=disturbance)
    context = replace(sideways, recording=replace(sideways.recording, scenario=scenario))
    lines, caption = drawn(context)
    assert lines == []
    assert caption.endswith(f'No exact response is drawn: {why}.')
