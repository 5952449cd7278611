# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The scenarios of six struts: what they identify is trusted, so that their laws do not run on fallbacks."""

import pytest
from satvib_common.phases import Phase
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop


@pytest.mark.parametrize('name', ['hexapod_6dof', 'hexapod_6dof_wheel'])
def test_every_strut_of_a_hexapod_has_a_trusted_model(name):
    """Truth: the trust checks of every strut at the end of IDENTIFY."""
    loop = ClosedLoop(load_scenario(name))
    found = None
    for step in loop.steps():
        if step.phase not in (Phase.CALIBRATE, Phase.IDENTIFY):
            break
        found = step.identification
    assert found is not None
    assert found.converged.tolist() == [True] * 6, found.reasons
