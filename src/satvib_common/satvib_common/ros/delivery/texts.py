# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where the texts of a message stand in its bytes.

rclpy takes a text by its length and does not look whether it ends with its zero. Some readers of bags do, and stop
there.

The bytes are CDR: each number stands at a multiple of its size, counted from the end of the encapsulation. A list has
its length before it, and so does a text, whose length counts its final zero.
"""

import re
import struct
from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import Any

# of ROS: of the module struct
NUMBERS = {
    'boolean': '?', 'octet': 'B', 'uint8': 'B', 'int8': 'b', 'uint16': 'H', 'int16': 'h',
    'uint32': 'I', 'int32': 'i', 'uint64': 'Q', 'int64': 'q', 'float': 'f', 'double': 'd',
}  # fmt: skip
_ENCAPSULATION = 4  # bytes
_LENGTH = 4  # bytes
_LIST = re.compile(r'sequence<(?P<of>.+?)(, \d+)?>|(?P<of_fixed>.+)\[(?P<count>\d+)\]')
_TEXT = re.compile(r'string(<\d+>)?')

# bytes, place of a field in them, 'little' or 'big', spans of the texts so far: the place after the field
_Step = Callable[[bytes, int, Any, list[tuple[int, int]]], int]


def spans_of_texts(data: bytes, kind: Any) -> list[tuple[int, int]]:
    """Give where each text of a message begins and ends in its bytes, with its final zero.

    Args:
        data: bytes of a message that rclpy can read.
        kind: its class.

    Raises:
        ValueError: the bytes end before a text does, or the kind holds something that is not known here.
    """
    spans: list[tuple[int, int]] = []
    _steps_of(kind)(data, 0, 'little' if data[1] & 1 else 'big', spans)
    if spans and spans[-1][1] > len(data):
        raise ValueError('the bytes end within a text')
    return spans


@cache
def _steps_of(kind: Any) -> _Step:
    """Walk over all fields of a kind of messages."""
    steps = [_step_of(what) for what in kind.get_fields_and_field_types().values()]

    def walk(data: bytes, at: int, order: Any, spans: list[tuple[int, int]]) -> int:
        for step in steps:
            at = step(data, at, order, spans)
        return at

    return walk


def _step_of(what: str) -> _Step:
    """Walk over one field, by the name of its type."""
    if what in NUMBERS:
        return _numbers(struct.calcsize(NUMBERS[what]), 1)
    if _TEXT.fullmatch(what):
        return _text
    if found := _LIST.fullmatch(what):
        count = int(found['count']) if found['count'] else None
        return _list(found['of'] or found['of_fixed'], count)
    package, _, name = what.partition('/')
    if not name:
        raise ValueError(f'a field of type {what}')
    return _steps_of(getattr(import_module(f'{package}.msg'), name))


def _numbers(size: int, count: int) -> _Step:
    def walk(_: bytes, at: int, __: Any, ___: list[tuple[int, int]]) -> int:
        return at + -at % size + size * count

    return walk


def _length(data: bytes, at: int, order: Any) -> int:
    place = _ENCAPSULATION + at
    return int.from_bytes(data[place : place + _LENGTH], order)


def _text(data: bytes, at: int, order: Any, spans: list[tuple[int, int]]) -> int:
    at += -at % _LENGTH
    begin = at + _LENGTH
    end = begin + _length(data, at, order)
    spans.append((_ENCAPSULATION + begin, _ENCAPSULATION + end))
    return end


def _list(of: str, count: int | None) -> _Step:
    """Walk over a list; `count` is None where its length stands before it."""
    size = struct.calcsize(NUMBERS[of]) if of in NUMBERS else 0
    step = _numbers(size, 1) if size else _step_of(of)

    def walk(data: bytes, at: int, order: Any, spans: list[tuple[int, int]]) -> int:
        number = count
        if number is None:
            at += -at % _LENGTH
            number = _length(data, at, order)
            at += _LENGTH
        if size:  # as one, for a list of numbers is long
            return at + -at % size + size * number if number else at
        for _ in range(number):
            at = step(data, at, order, spans)
            if at > len(data):
                raise ValueError('the bytes end within a list')
        return at

    return walk
