# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Changes to a mapping from the command line: 'key=value' with dots for nested keys."""

from collections.abc import Sequence
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.schema import parse_yaml


def parse_override(text: str) -> tuple[str, Any]:
    """Split 'key=value'; the value is read as YAML.

    Raises:
        SatvibError: no equals sign, no key, or a value that is not YAML.
    """
    key, equals, value = text.partition('=')
    key = key.strip()
    if not equals or not key or any(not part for part in key.split('.')):
        raise SatvibError(f'--set {text}: key=value is expected, with dots for nested keys')
    return key, parse_yaml(value, f'--set {text}')


def apply_overrides(data: dict[str, Any], overrides: Sequence[str]) -> None:
    """Change a scenario's mapping in place; 'rig.payload.mass=12' becomes an entry of `rig_overrides`.

    Whether the key exists is checked later, by the schema that it belongs to.

    Raises:
        SatvibError: an override that cannot be read, or a dotted key below something that is no mapping.
    """
    for text in overrides:
        apply_value(data, *parse_override(text), text)


def apply_value(data: dict[str, Any], key: str, value: Any, text: str) -> None:
    """Change one dotted key of a scenario's mapping in place; `text` is what messages show.

    Raises:
        SatvibError: a key below something that is no mapping.
    """
    head, _, rest = key.partition('.')
    if head in {'rig', 'rig_overrides'} and rest:
        data['rig_overrides'] = {**(data.get('rig_overrides') or {}), rest: value}
    else:
        _assign(data, key.split('.'), value, text)


def _assign(data: Any, parts: list[str], value: Any, text: str) -> None:
    *parents, last = parts
    for part in parents:
        if isinstance(data, dict) and data.get(part) is None:
            data[part] = {}
        data = data[_index(data, part, text)]
    data[_index(data, last, text)] = value


def _index(data: Any, part: str, text: str) -> Any:
    if isinstance(data, dict):
        return part
    if isinstance(data, list) and part.isdecimal() and int(part) < len(data):
        return int(part)
    raise SatvibError(f'--set {text}: nothing is called {part} there')
