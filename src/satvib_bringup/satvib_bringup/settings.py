# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Small helpers for names and paths in settings files."""

import difflib
from collections.abc import Sequence
from pathlib import Path


def unknown_name(name: str, known: Sequence[str]) -> str:
    """Words for a name that nothing has, with the nearest one that something has."""
    close = difflib.get_close_matches(name, known, n=1)
    hint = f'did you mean {close[0]}? ' if close else ''
    return f'no such name; {hint}(known: {", ".join(known)}; or give the path of a .yaml file)'


def resolve_path(name_or_path: str, folder: Path) -> str:
    """Make a relative path in a settings file relative to that file; leave names as they are."""
    if name_or_path.endswith(('.yaml', '.yml')) and not Path(name_or_path).is_absolute():
        return str((folder / name_or_path).resolve())
    return name_or_path
