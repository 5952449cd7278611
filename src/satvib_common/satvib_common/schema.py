# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Self-validating frozen dataclasses: one engine for node parameters, rigs and scenarios.

@dataclass(frozen=True, kw_only=True)
class Coil(Schema):
    resistance: float = param(2.7, 'winding resistance', unit='ohm', above=0.0)

Coil.from_mapping({'resistance': -1}, 'rig paper_3dof: coil')
-> SatvibError: rig paper_3dof: coil.resistance: -1.0 is not above 0.0 ohm
"""

import dataclasses
import difflib
import math
import reprlib
import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from typing import Any, Self

from satvib_common.errors import SatvibError, printable

_KEY = 'satvib'
_MOST_MISSING = 30  # keys in a line
LARGEST_INTEGER = 2**63 - 1  # what a message, a table and an array of whole numbers hold
_SHORT = reprlib.Repr()  # a few elements of what may be very large
_SHORT.maxlevel = 3
_SHORT.maxstring = 60


def shown(value: Any) -> str:
    """Give a value for a message, short however large it is."""
    return _SHORT.repr(value)


class Fixed(StrEnum):
    """Why a parameter of a node is read-only."""

    RIG = 'it describes the rig, which stays as it is while a node runs'
    MODEL = 'what is designed from the identified model depends on it'
    MEMORY = 'what is kept from sample to sample is laid out for it'
    ESTIMATE = 'the estimate so far rests on it'
    GRAPH = 'the other nodes of the graph rely on the same value'
    START = 'it is used once, at the start of the node'
    PROTECTION = 'it belongs to a protection, which is not changed while it is needed'


@dataclass(frozen=True)
class Constraint:
    """What a field may hold; bounds hold for every element of a sequence.

    `read_only` says why a running node does not take another value, as a `Fixed` or in words; empty: it does.
    """

    description: str
    unit: str = ''
    minimum: float | None = None
    maximum: float | None = None
    above: float | None = None
    below: float | None = None
    choices: tuple[Any, ...] | None = None
    read_only: str = ''
    finite: bool = True

    def complaint(self, value: Any) -> str | None:
        """Why one value is refused, None when it is not."""
        unit = f' {self.unit}' if self.unit else ''
        if self.choices is not None and value not in self.choices:
            return f'{shown(value)} is not one of {", ".join(map(str, self.choices))}'
        if isinstance(value, bool) or not isinstance(value, int | float):
            return None
        if self.finite and not math.isfinite(value):
            return f'{value} is not a finite number'
        if self.above is not None and not value > self.above:
            return f'{value} is not above {self.above}{unit}'
        if self.below is not None and not value < self.below:
            return f'{value} is not below {self.below}{unit}'
        if self.minimum is not None and not value >= self.minimum:
            return f'{value} is less than {self.minimum}{unit}'
        if self.maximum is not None and not value <= self.maximum:
            return f'{value} is more than {self.maximum}{unit}'
        return None


def param(default: Any = dataclasses.MISSING, description: str = '', **constraint: Any) -> Any:
    """Declare a field: its default, what it is, and the keywords of `Constraint`.

    Without a default the field is required. A mutable default is a mistake; use tuples. The class `dict` as default
    means an empty mapping, a new one for every object.
    """
    metadata = {_KEY: Constraint(description, **constraint)}
    if default is dict:
        return dataclasses.field(default_factory=dict, metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def constraint_of(field: dataclasses.Field[Any]) -> Constraint:
    """Give the constraint of a field of a schema."""
    found: Constraint = field.metadata.get(_KEY, Constraint(''))
    return found


_KNOWN_HINTS: dict[type, dict[str, Any]] = {}


def _hints(cls: type) -> dict[str, Any]:
    """Types of a schema's fields; kept, because looking them up would be most of the work of making an object."""
    found = _KNOWN_HINTS.get(cls)
    if found is None:
        found = _KNOWN_HINTS[cls] = typing.get_type_hints(cls)
    return found


@dataclass(frozen=True)
class Schema:
    """Base of every checked value object; subclasses are frozen, keyword-only dataclasses."""

    def __post_init__(self) -> None:
        """Check each field, then the whole."""
        self._check_fields()
        self.check()
        self.check_start()

    def _check_fields(self) -> None:
        hints = _hints(type(self))
        for field in dataclasses.fields(self):
            value = _coerced(getattr(self, field.name), hints[field.name], field.name)
            object.__setattr__(self, field.name, value)
            elements = value if isinstance(value, tuple) else (value,)
            for element in elements:
                complaint = constraint_of(field).complaint(element) if element is not None else None
                if complaint:
                    raise SatvibError(f'{field.name}: {complaint}')

    def check(self) -> None:
        """Check what concerns several fields; raises SatvibError."""

    def check_start(self) -> None:
        """Check what concerns several fields and may be otherwise after a change (`changed`); raises SatvibError."""

    def check_change(self, before: Self) -> None:
        """Check what a change from `before` must not do while a node runs; raises SatvibError."""

    @classmethod
    def from_mapping(cls, mapping: Any, where: str = '') -> Self:
        """Build from plain data (as YAML gives it), every key checked.

        Args:
            mapping: keys are field names; nested schemas are mappings, sequences of them lists.
            where: the start of the message when something is wrong, for instance the file.

        Raises:
            SatvibError: an unknown or missing key, a wrong type, a value out of range.
        """
        prefix = f'{where}: ' if where else ''
        if not isinstance(mapping, Mapping):
            raise SatvibError(f'{prefix}a mapping of keys is expected, not {_typed(mapping)}')
        try:
            hints = _hints(cls)
            if missing := _missing(cls, mapping):
                more = len(missing) - _MOST_MISSING
                rest = f' and {more} more' if more > 0 else ''
                raise SatvibError(f'{", ".join(missing[:_MOST_MISSING])}{rest}: missing')
            return cls(**{k: _built(v, hints[k], str(k)) for k, v in mapping.items()})
        except SatvibError as error:
            raise SatvibError(f'{prefix}{error}') from None

    def to_mapping(self) -> dict[str, Any]:
        """Give plain data that `from_mapping` takes back."""
        return {f.name: _plain(getattr(self, f.name)) for f in dataclasses.fields(self)}

    def changed(self, changes: Mapping[str, Any]) -> Self:
        """Give a copy with some fields changed, as a running node takes it: `check_change` instead of `check_start`.

        Raises:
            SatvibError: a wrong type, a value out of range, a set or a change that is refused.
        """
        hints = _hints(type(self))
        new = object.__new__(type(self))
        for field in dataclasses.fields(self):
            name = field.name
            given = name in changes
            value = _built(changes[name], hints[name], name) if given else getattr(self, name)
            object.__setattr__(new, name, value)
        new._check_fields()
        new.check()
        new.check_change(self)
        return new

    def replace(self, **changes: Any) -> Self:
        """Give a checked copy with some fields changed."""
        return dataclasses.replace(self, **changes)


def _typed(value: Any) -> str:
    return 'nothing' if value is None else f'{type(value).__name__} {shown(value)}'


def _suggestion(key: str, known: list[str]) -> str:
    close = difflib.get_close_matches(key, known, n=1)
    return f'; did you mean {close[0]}?' if close else f' (known: {", ".join(known)})'


def _missing(cls: type[Schema], mapping: Mapping[Any, Any], within: str = '') -> list[str]:
    """Name every key that is missing, in nested mappings too: they are told at once.

    Raises:
        SatvibError: a key that there is not, which may be the missing one misspelt.
    """
    hints = _hints(cls)
    fields = {f.name: f for f in dataclasses.fields(cls)}
    for key in mapping:
        if key not in fields:
            name = printable(str(key), 60)
            raise SatvibError(f'{within}{name}: no such key{_suggestion(name, list(fields))}')
    found = []
    for name, field in fields.items():
        if name in mapping:
            found += _missing_inside(mapping[name], hints[name], f'{within}{name}')
        elif (field.default, field.default_factory) == (dataclasses.MISSING,) * 2:
            found.append(f'{within}{name}')
    return found


def _missing_inside(value: Any, hint: Any, name: str) -> list[str]:
    """Name the keys that are missing in the nested schemas of a value."""
    if not isinstance(value, Mapping | list | tuple):
        return []
    for option in _options(hint):
        if isinstance(option, type) and issubclass(option, Schema):
            if isinstance(value, Mapping):
                return _missing(option, value, f'{name}.')
        elif typing.get_origin(option) is tuple and isinstance(value, list | tuple):
            inner = typing.get_args(option)[0]
            return [
                m for i, v in enumerate(value) for m in _missing_inside(v, inner, f'{name}[{i}]')
            ]
    return []


@lru_cache(maxsize=512)
def _options(hint: Any) -> tuple[Any, ...]:
    """Alternatives of a union, or the hint alone."""
    if typing.get_origin(hint) in {typing.Union, types.UnionType}:
        return typing.get_args(hint)
    return (hint,)


def _built(value: Any, hint: Any, name: str) -> Any:
    """Turn nested mappings into nested schemas, lists into tuples, recursively."""
    for option in _options(hint):
        if isinstance(option, type) and issubclass(option, Schema):
            if isinstance(value, Mapping):
                return _nested(value, option, name)
        elif typing.get_origin(option) is tuple and isinstance(value, list | tuple):
            inner = typing.get_args(option)[0]
            return tuple(_built(v, inner, f'{name}[{i}]') for i, v in enumerate(value))
    return value


def _nested(value: Any, cls: type[Schema], name: str) -> Schema:
    try:
        return cls.from_mapping(value)
    except SatvibError as error:
        raise SatvibError(f'{name}.{error}') from None


def _coerced(value: Any, hint: Any, name: str) -> Any:
    """Check a value against a type hint; an int is a float where a float is wanted."""
    options = _options(hint)
    for option in options:
        origin = typing.get_origin(option) or option
        if origin is Any:
            return value
        if origin is tuple and isinstance(value, list | tuple):
            inner = typing.get_args(option)[0]
            return tuple(_coerced(v, inner, f'{name}[{i}]') for i, v in enumerate(value))
        if origin is float and isinstance(value, int | float) and not isinstance(value, bool):
            return _float(value, name)
        if origin is int and isinstance(value, bool):
            continue
        if origin is int and isinstance(value, int) and abs(value) > LARGEST_INTEGER:
            raise SatvibError(f'{name}: {shown(value)} is beyond 2^63 - 1')
        if isinstance(origin, type) and isinstance(value, origin):
            return _with_text_keys(value, name) if origin is dict else value
    wanted = ' or '.join(_type_name(o) for o in options)
    raise SatvibError(f'{name}: {wanted} is expected, not {_typed(value)}')


def _float(value: float, name: str) -> float:
    try:
        return float(value)
    except OverflowError:
        raise SatvibError(f'{name}: {shown(value)} is too large for a number') from None


def _with_text_keys(value: Any, name: str) -> Any:
    for key in value:
        if not isinstance(key, str):
            raise SatvibError(f'{name}: the key {shown(key)} is not text')
    return value


def _type_name(hint: Any) -> str:
    if hint is type(None):
        return 'nothing'
    if typing.get_origin(hint) is tuple:
        return f'a list of {_type_name(typing.get_args(hint)[0])}'
    return {
        'float': 'a number',
        'int': 'a whole number',
        'str': 'text',
        'bool': 'true or false',
    }.get(getattr(hint, '__name__', ''), f'a {getattr(hint, "__name__", hint)}')


def _plain(value: Any) -> Any:
    if isinstance(value, Schema):
        return value.to_mapping()
    if isinstance(value, tuple):
        return [_plain(v) for v in value]
    if isinstance(value, Mapping):
        return {k: _plain(v) for k, v in value.items()}
    return value
