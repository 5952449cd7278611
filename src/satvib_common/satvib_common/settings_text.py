# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Settings as text: 'key=value', the value as YAML has it, with dots in the key for what lies inside.

    seed=7        disturbance.amplitude=0.2        phases.1.start=9.0        rig.payload.mass=12

Elements of a list count from 0. Every setting of satvib that is text is read here, and put in its place here.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import parse_yaml

# keys of a rig become entries of this key of a scenario
RIG_CHANGES = 'rig_overrides'


def is_key(text: object) -> bool:
    """Whether a text is a key: names with dots between them."""
    return isinstance(text, str) and all(text.split('.'))


def parse_setting(text: str, where: str) -> tuple[str, Any]:
    """Split 'key=value'.

    Args:
        text: the setting.
        where: what begins the message when it is wrong, as in '--set'.

    Raises:
        SatvibError: no equals sign, no key, or a value that is not YAML.
    """
    key, equals, value = text.partition('=')
    key = key.strip()
    if not equals or not is_key(key):
        raise SatvibError(f'{where} {text}: key=value is expected, with dots for nested keys')
    return key, parse_yaml(value, f'{where} {text}')


def parse_settings(texts: Iterable[str], where: str) -> dict[str, Any]:
    """Read several settings, by key; blank ones are left out. Raises as `parse_setting`."""
    return dict(parse_setting(text, where) for text in texts if text.strip())


def setting_text(key: str, value: Any) -> str:
    """Give the 'key=value' that `parse_setting` reads back; numbers keep all their digits."""
    return f'{key}={json.dumps(value)}'


def assign(data: Any, key: str, value: Any, where: str, grow: bool = False) -> None:
    """Set one dotted key in nested mappings and lists, in place.

    Args:
        data: the outermost mapping.
        key: with dots.
        value: the new one.
        where: what begins the message when the key does not fit.
        grow: add keys that are not there; a schema checks them later.

    Raises:
        SatvibError: a part of the key that is not there, or a value in the place of a group of keys.
    """
    *parents, last = key.split('.')
    for depth, part in enumerate(parents):
        if grow and isinstance(data, dict) and data.get(part) is None:
            data[part] = {}
        data = _child(data, part)
        if not isinstance(data, dict | list):
            path = '.'.join(parents[: depth + 1])
            raise SatvibError(f'{where}: {path} has no keys below it or does not exist')
    if isinstance(data, list):
        if not last.isdecimal() or int(last) >= len(data):
            raise SatvibError(f'{where}: {last} is not an index from 0 to {len(data) - 1}')
        data[int(last)] = value
        return
    if not grow and last not in data:
        raise SatvibError(f'{where}: no such key (known here: {", ".join(data)})')
    if not grow and isinstance(data[last], dict) and not isinstance(value, Mapping):
        raise SatvibError(f'{where}: is a group of keys, name one of {", ".join(data[last])}')
    data[last] = value


def _child(data: Any, part: str) -> Any:
    if isinstance(data, list):
        return data[int(part)] if part.isdecimal() and int(part) < len(data) else None
    return data.get(part)


def change_existing(data: dict[str, Any], changes: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Set dotted keys that exist, in place; gives the same mapping. Raises as `assign`."""
    for key, value in changes.items():
        assign(data, key, value, f'{where}: {key}')
    return data


def change_setting(data: dict[str, Any], key: str, value: Any, where: str) -> None:
    """Set one dotted key of a scenario's mapping; a key of its rig is kept in `rig_overrides`. Raises as `assign`."""
    head, _, rest = key.partition('.')
    if head in {'rig', RIG_CHANGES} and rest:
        present = data.get(RIG_CHANGES) or {}
        if not isinstance(present, Mapping):
            raise SatvibError(f'{where}: {RIG_CHANGES} is not a mapping of keys')
        data[RIG_CHANGES] = {**present, rest: value}
    else:
        assign(data, key, value, where, grow=True)


def change_settings(data: dict[str, Any], texts: Sequence[str]) -> None:
    """Apply the 'key=value' of `--set` to a scenario's mapping, in place.

    Whether a key exists is checked later, by the schema that it belongs to.

    Raises:
        SatvibError: a text that is not key=value, or a key that does not fit.
    """
    for text in texts:
        key, value = parse_setting(text, '--set')
        change_setting(data, key, value, f'--set {text}')
