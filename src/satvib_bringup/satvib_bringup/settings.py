# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Small helpers for names and paths in settings and files."""

import difflib
from collections.abc import Sequence
from pathlib import Path


def nearest(name: str, known: Sequence[str]) -> str:
    """Words that lead from a wrong name to the right one."""
    close = difflib.get_close_matches(name, known, n=1)
    listed = f'known: {", ".join(known)}'
    return f'did you mean {close[0]}? ({listed})' if close else listed


def resolve_path(name_or_path: str, folder: Path) -> str:
    """Make a relative path in a settings file relative to that file; leave names as they are."""
    if name_or_path.endswith(('.yaml', '.yml')) and not Path(name_or_path).is_absolute():
        return str((folder / name_or_path).resolve())
    return name_or_path
