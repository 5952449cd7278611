# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One experiment: what is run, the offline twin that runs it, what was recorded, and the report."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.analysis.analysis import analyse
    from satvib_experiment.analysis.evaluation import Evaluation, evaluate
    from satvib_experiment.recording.load import load_recording
    from satvib_experiment.recording.recording import Recording, differences
    from satvib_experiment.report.build import Report, write_report
    from satvib_experiment.scenario.folder import scenario_names
    from satvib_experiment.scenario.scenario import (
        Scenario,
        check_scenario,
        load_scenario,
    )
    from satvib_experiment.twin.closed_loop import (
        ClosedLoop,
        simulate,
        simulate_batch,
        simulate_open_loop,
    )
    from satvib_experiment.twin.step import LoopStep

__all__ = [
    'ClosedLoop',
    'Evaluation',
    'LoopStep',
    'Recording',
    'Report',
    'Scenario',
    'analyse',
    'check_scenario',
    'differences',
    'evaluate',
    'load_recording',
    'load_scenario',
    'scenario_names',
    'simulate',
    'simulate_batch',
    'simulate_open_loop',
    'write_report',
]
__getattr__, __dir__ = door(__name__, __file__)
