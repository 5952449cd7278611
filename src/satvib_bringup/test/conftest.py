# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A run that several test files look at."""

import pytest
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate


@pytest.fixture(scope='session')
def quick_run():
    """The recording of the scenario of four seconds."""
    return simulate(load_scenario('quick_3dof'))
