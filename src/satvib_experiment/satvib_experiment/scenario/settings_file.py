# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Names, paths and contents of settings files: what scenarios, studies and campaigns share."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest
from satvib_common.files.yaml_file import load_yaml
from satvib_common.settings_text import change_settings

# keys that begin so hold what the file uses elsewhere, by anchor and alias
ASIDE = ('x_', 'x-')


def resolve_path(name_or_path: str, folder: Path) -> str:
    """Make a relative path in a settings file relative to that file; leave names as they are."""
    if name_or_path.endswith(('.yaml', '.yml')) and not Path(name_or_path).is_absolute():
        return str((folder / name_or_path).resolve())
    return name_or_path


def names_in(folder: Path) -> list[str]:
    """Names of the settings files of a folder that comes with the package."""
    return sorted(path.stem for path in folder.glob('*.yaml'))


def settings_path(kind: str, name_or_path: str | Path, folder: Path) -> Path:
    """Where a settings file is.

    Args:
        kind: what it is, for the error.
        name_or_path: a name in the package's folder, or the path of a YAML file.
        folder: the package's.

    Raises:
        SatvibError: no such name.
    """
    text = str(name_or_path)
    if text.endswith(('.yaml', '.yml')) or '/' in text:
        return Path(text)
    known = names_in(folder)
    if text not in known:
        raise SatvibError(f'{kind} {text!r}: no such {kind}; {nearest(text, known)}')
    return folder / f'{text}.yaml'


def load_settings(path: Path, overrides: Sequence[str] = ()) -> dict[str, Any]:
    """Read a settings file and change it by 'key=value', with dots for nested keys.

    A key that begins with x_ or x- is left out: what stands there is for anchors.

    Raises:
        SatvibError: it cannot be read, is no mapping, or a change does not fit.
    """
    data = load_yaml(path)
    if not isinstance(data, dict):
        raise SatvibError(f'{path}: a mapping of keys is expected')
    data = {key: value for key, value in data.items() if not str(key).startswith(ASIDE)}
    change_settings(data, overrides)
    return data
