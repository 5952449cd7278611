# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Folders of runs: a new one each time, nothing ever overwritten."""

import re
from pathlib import Path

import yaml
from satvib_common.errors import SatvibError

from satvib_bringup.scenario import Scenario

RUNS = Path('runs')


def new_run_folder(name: str, wanted: Path | None = None, base: Path = RUNS) -> Path:
    """Make the folder of a run.

    Args:
        name: of the scenario.
        wanted: the folder to make; None: the next free `base`/<name>-<number>.
        base: where numbered runs go.

    Raises:
        SatvibError: the wanted folder is there already, or the place cannot be written.
    """
    try:
        if wanted is not None:
            wanted.parent.mkdir(parents=True, exist_ok=True)
            wanted.mkdir()
            return wanted
        base.mkdir(parents=True, exist_ok=True)
        number = 1 + max((_number(p.name, name) for p in base.iterdir()), default=0)
        while True:
            folder = base / f'{name}-{number:03d}'
            try:
                folder.mkdir()
            except FileExistsError:  # another run was quicker
                number += 1
            else:
                return folder
    except FileExistsError:
        raise SatvibError(f'{wanted}: exists already, nothing is overwritten') from None
    except OSError as error:
        place = wanted or base
        raise SatvibError(f'{place}: the folder cannot be made: {error.strerror}') from None


def _number(folder: str, name: str) -> int:
    found = re.fullmatch(re.escape(name) + r'-(\d+)', folder)
    return int(found[1]) if found else 0


def write_scenario(scenario: Scenario, folder: Path) -> None:
    """Write the scenario as it was run, overrides included, to scenario.yaml.

    Raises:
        SatvibError: the file cannot be written.
    """
    path = folder / 'scenario.yaml'
    try:
        with path.open('x', encoding='utf-8') as sink:
            yaml.safe_dump(scenario.to_mapping(), sink, sort_keys=False, width=100)
    except OSError as error:
        raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None
