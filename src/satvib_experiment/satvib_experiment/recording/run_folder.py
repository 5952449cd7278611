# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Folders of runs: a new one each time, nothing ever overwritten."""

import re
from pathlib import Path
from typing import TYPE_CHECKING

import yaml
from satvib_common.errors import SatvibError
from satvib_common.files.disk import MEGABYTE, room_at
from satvib_common.files.folder_name import check_folder_name

if TYPE_CHECKING:  # it brings all that a scenario is made of
    from satvib_experiment.scenario.scenario import Scenario

RUNS = Path('runs')
# bytes of a report with its figures, and some
_ROOM = 8 * MEGABYTE


def free_run_folder(name: str, wanted: Path | None = None, base: Path = RUNS) -> Path:
    """Find the folder of a run, which does not exist yet.

    Args:
        name: of the scenario.
        wanted: the folder to take; None: the next free `base`/<name>-<number>.
        base: where numbered runs go.

    Raises:
        SatvibError: the wanted folder is there already, the place cannot be looked into, or the name is none for
            a folder.
    """
    if wanted is not None:
        if wanted.exists() or wanted.is_symlink():
            raise SatvibError(f'{wanted}: exists already, nothing is overwritten')
        return wanted
    check_folder_name(name)
    try:
        numbers = [_number(path.name, name) for path in base.iterdir()] if base.exists() else []
    except OSError as error:
        raise SatvibError(f'{base}: runs cannot be kept there: {error.strerror}') from None
    return base / f'{name}-{1 + max(numbers, default=0):03d}'


def check_room(folder: Path) -> None:
    """Refuse to begin something long whose result would not fit on the disk.

    Raises:
        SatvibError: there is less than a report takes.
    """
    if (room := room_at(folder)) < _ROOM:
        raise SatvibError(
            f'{folder}: the disk has {room / MEGABYTE:.1f} MB left, a run needs '
            f'{_ROOM / MEGABYTE:.0f}; make room'
        )


def make_run_folder(folder: Path) -> None:
    """Make the folder of a run.

    Raises:
        SatvibError: it is there already, the place cannot be written, or the disk is as good as full.
    """
    check_room(folder)
    try:
        folder.mkdir(parents=True)
    except FileExistsError:
        raise SatvibError(f'{folder}: exists already, nothing is overwritten') from None
    except (OSError, ValueError) as error:  # ValueError: NUL in the path
        reason = getattr(error, 'strerror', None) or error
        raise SatvibError(f'{folder}: the folder cannot be made: {reason}') from None


def _number(folder: str, name: str) -> int:
    found = re.fullmatch(re.escape(name) + r'-(\d+)', folder)
    return int(found[1]) if found else 0


def write_scenario(scenario: 'Scenario', folder: Path, name: str = 'scenario.yaml') -> None:
    """Write the scenario as it was run, overrides included, to a file of the folder.

    Raises:
        SatvibError: the file cannot be written.
    """
    path = folder / name
    try:
        with path.open('x', encoding='utf-8') as sink:
            yaml.safe_dump(scenario.to_mapping(), sink, sort_keys=False, width=100)
    except OSError as error:
        raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None
