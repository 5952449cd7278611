# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The scenarios that come with the package, listed from their files alone: no numerical library is imported."""

from pathlib import Path
from typing import NamedTuple

from satvib_experiment.scenario.settings_file import load_settings, names_in, settings_path

FOLDER = Path(__file__).parents[1] / 'scenarios'


class Listed(NamedTuple):
    """A scenario as its file describes it."""

    name: str
    rig: str
    law: str
    duration: float
    description: str


def scenario_names() -> list[str]:
    """Names of the scenarios that come with the package."""
    return names_in(FOLDER)


def scenario_path(name_or_path: str | Path) -> Path:
    """Where a scenario is.

    Raises:
        SatvibError: neither a name of the package's nor a file.
    """
    return settings_path('scenario', name_or_path, FOLDER)


def listed_scenarios() -> list[Listed]:
    """Describe every scenario of the package; what is in the files is not checked."""
    found = []
    for name in scenario_names():
        data = load_settings(FOLDER / f'{name}.yaml')
        central = data.get('scheme') == 'centralized'
        law = (
            data.get('centralized', {}).get('law', 'centralized')
            if central
            else data['controller']['law']
        )
        found.append(Listed(name, data['rig'], law, data['duration'], data.get('description', '')))
    return found
