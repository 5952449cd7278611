# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rehearsal before a run in real time."""

import pytest
from satvib_common.phases import Phase
from satvib_control.core.controller import ControllerCore
from satvib_control.core.rehearsal import rehearse
from satvib_control.parameters import ControllerParameters


@pytest.mark.parametrize('law', ['off', 'model_reference', 'narrowband', 'feedforward'])
def test_every_phase_is_rehearsed(law):
    """Truth: the table of phases; every law sees each of them, without a fault."""
    core = ControllerCore(ControllerParameters(law=law, sample_rate=200.0))
    seen = []
    step = core.law.step
    core.law.step = lambda sample, phase: seen.append(phase) or step(sample, phase)
    rehearse(core)
    assert set(seen) == set(Phase)
    assert not core._last.fault.any()
