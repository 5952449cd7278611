# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A message as text: one line a field, phases with their names, long arrays cut."""

from collections.abc import Iterator
from typing import Any

from satvib_common.phases import Phase

_SHOWN = 8  # elements of an array
_LEVELS = ('OK', 'WARN', 'ERROR', 'STALE')  # of diagnostic_msgs/DiagnosticStatus


def text_of(message: Any) -> str:
    """Give the fields of a message in their order, nested ones indented.

    A phase has its name beside the number: `phase: 4 (CONTROL)`. So has the level of a diagnostic.
    """
    return '\n'.join(_lines(message, ''))


def _lines(message: Any, indent: str) -> Iterator[str]:
    for name in message.get_fields_and_field_types():
        value = getattr(message, name)
        if hasattr(value, 'get_fields_and_field_types'):
            yield f'{indent}{name}:'
            yield from _lines(value, indent + '  ')
        elif _is_list(value) and len(value) and hasattr(value[0], 'get_fields_and_field_types'):
            yield f'{indent}{name}:'
            for item in value:
                inner = list(_lines(item, indent + '    '))
                yield f'{indent}  - {inner[0].strip()}'
                yield from inner[1:]
        else:
            yield f'{indent}{name}: {_shown(name, value)}'


def _is_list(value: Any) -> bool:
    return not isinstance(value, str | bytes) and hasattr(value, '__len__')


def _shown(name: str, value: Any) -> str:
    if _is_list(value):
        first = [_shown(name.removesuffix('s'), item) for item in list(value)[:_SHOWN]]
        more = f', ... {len(value)} in all' if len(value) > _SHOWN else ''
        return f'[{", ".join(first)}{more}]'
    if name == 'phase' and value in set(Phase):
        return f'{value} ({Phase(value).name})'
    if name == 'level' and isinstance(value, bytes) and value and value[0] < len(_LEVELS):
        return f'{value[0]} ({_LEVELS[value[0]]})'
    if isinstance(value, float):
        return f'{value:.6g}'
    return str(value)
