# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is run: scenarios and settings files, checked when they are loaded."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.scenario.folder import listed_scenarios, scenario_names
    from satvib_experiment.scenario.scenario import (
        AnalysisSettings,
        PhaseStep,
        Scenario,
        check_scenario,
        load_scenario,
    )
    from satvib_experiment.scenario.settings_file import (
        load_settings,
        names_in,
        resolve_path,
        settings_path,
    )

__all__ = [
    'AnalysisSettings',
    'PhaseStep',
    'Scenario',
    'check_scenario',
    'listed_scenarios',
    'load_scenario',
    'load_settings',
    'names_in',
    'resolve_path',
    'scenario_names',
    'settings_path',
]
__getattr__, __dir__ = door(__name__, __file__)
