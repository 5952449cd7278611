# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Names, paths and contents of settings files: what scenarios, studies and campaigns share."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest
from satvib_common.files.yaml_file import load_yaml
from satvib_common.settings_text import change_settings, parse_setting, setting_text

# keys that begin so hold what the file uses elsewhere, by anchor and alias
ASIDE = ('x_', 'x-')
# keys of a scenario that may hold the path of a file
SCENARIO_PATHS = ('rig', 'controller.file', 'centralized.file')


def resolve_path(name_or_path: str, folder: Path) -> str:
    """Make a relative path in a settings file relative to that file; leave names as they are."""
    if name_or_path.endswith(('.yaml', '.yml')) and not Path(name_or_path).is_absolute():
        return str((folder / name_or_path).resolve())
    return name_or_path


def resolve_paths(key: str, value: Any, paths: Sequence[str], folder: Path) -> Any:
    """Make the relative paths in a value of settings relative to a folder.

    Args:
        key: of the value, with dots.
        value: text, or a mapping with keys of its own; anything else stays as it is.
        paths: keys that hold paths, with dots.
        folder: what a relative path refers to.
    """
    if isinstance(value, Mapping):
        return {k: resolve_paths(f'{key}.{k}', v, paths, folder) for k, v in value.items()}
    return resolve_path(value, folder) if key in paths and isinstance(value, str) else value


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


def called(kind: str, path: Path, folder: Path) -> str:
    """How messages call a settings file: by its name where it comes with the package, else by its path."""
    return f'{kind} {path.stem}' if path.parent == folder else str(path)


def load_settings(
    path: Path, overrides: Sequence[str] = (), paths: Sequence[str] = ()
) -> dict[str, Any]:
    """Read a settings file and change it by 'key=value', with dots for nested keys.

    A key that begins with x_ or x- is left out: what stands there is for anchors.

    Args:
        path: of the file.
        overrides: the changes. A relative path in them refers to the current folder, not to that of the file.
        paths: keys that hold paths, with dots.

    Raises:
        SatvibError: it cannot be read, is no mapping, or a change does not fit.
    """
    data = load_yaml(path)
    if not isinstance(data, dict):
        raise SatvibError(f'{path}: a mapping of keys is expected')
    data = {key: value for key, value in data.items() if not str(key).startswith(ASIDE)}
    change_settings(data, [_from_here(text, paths) for text in overrides])
    return data


def _from_here(text: str, paths: Sequence[str]) -> str:
    """A 'key=value' with its paths absolute; one without paths stays as it was given."""
    key, value = parse_setting(text, '--set')
    resolved = resolve_paths(key, value, paths, Path.cwd())
    return text if resolved == value else setting_text(key, resolved)
