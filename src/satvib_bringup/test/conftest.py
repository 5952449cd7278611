# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A run that several test files look at, and reports without figures."""

import pytest
from satvib_experiment.report import drawing
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate


@pytest.fixture(scope='session')
def quick_run():
    """The recording of the scenario of four seconds."""
    return simulate(load_scenario('quick_3dof'))


@pytest.fixture
def no_figures(monkeypatch):
    """Leave the figures out of reports: they take longer than all else, and these tests say nothing of them."""
    monkeypatch.setattr(drawing, 'MOST', 0)
    monkeypatch.setattr(drawing, 'FIGURES', ())
