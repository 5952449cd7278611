# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of numbers and texts as the bytes that go over the wire, without rclpy's conversion.

rclpy makes a Python object of each message that arrives, with all that it holds, and takes one apart field by field to
send it: 5 to 15 us each time. The samples of a loop have few fields, and the same ones every time. One `struct` call
reads or writes them in 1 to 2 us.

The bytes are those of the middleware: CDR, little endian, each number at a multiple of its size, counted from the end
of the four bytes of encapsulation; a text as its length with the final zero, its bytes and the zero.
"""

import struct
from collections import namedtuple
from collections.abc import Callable, Iterator
from functools import cache
from operator import attrgetter
from types import SimpleNamespace
from typing import Any, NamedTuple

from rclpy.serialization import deserialize_message, serialize_message

from satvib_common.ros.delivery.texts import NUMBERS, spans_of_texts

_ENCAPSULATION = b'\x00\x01\x00\x00'
_LENGTH = struct.Struct('<I')
_FRAME = 12  # place of the length of frame_id
_TEXT = 'string'
_MOST_LAYOUTS = (
    256  # that are kept; the texts of a graph have a few lengths, those of a stranger any
)
_REPLACED = '\ufffd'  # what rclpy puts in the place of bytes that are no text
_MALFORMED = (struct.error, ValueError, IndexError, RuntimeError, MemoryError)
_HEADER = (('header.stamp.sec', 'int32'), ('header.stamp.nanosec', 'uint32'))


class UnreadableError(Exception):
    """Bytes that are no message of their kind, in one line: cut off, or of another version of the kind."""


class Stamp(NamedTuple):
    """As builtin_interfaces/Time."""

    sec: int
    nanosec: int


class Header(NamedTuple):
    """As std_msgs/Header."""

    stamp: Stamp
    frame_id: str


class Wire:
    """Bytes of the messages of one kind; made by `wire_of`.

    Args:
        kind: class of the messages.
        fields: path and type of each number and text, in order.
        headed: the messages begin with a std_msgs/Header.
    """

    def __init__(self, kind: Any, fields: list[tuple[str, str]], headed: bool) -> None:
        self._kind, self._types, self._headed = kind, [what for _, what in fields], headed
        paths = [path for path, _ in fields]
        values: Callable[[Any], Any] = attrgetter(*paths)
        self._values: Callable[[Any], Any] = (
            values if len(paths) > 1 else lambda message: (values(message),)
        )
        self._texts = [i for i, what in enumerate(self._types) if what == _TEXT]
        # a header and numbers: one text, and that in its place
        self._plain = headed and len(self._texts) == 1
        names = ['header', *paths[3:]] if headed else paths
        self._record = namedtuple(kind.__name__, names)  # type: ignore[misc]
        self._layouts: dict[tuple[int, ...], struct.Struct] = {}

    def pack(self, message: Any) -> bytes:
        """Give the bytes of a message, or of anything with the same attributes."""
        found = self._values(message)
        if self._plain:
            sec, nanosec, frame, *rest = found
            text = frame.encode()
            layout = self._layouts.get((len(text) + 1,)) or self._layout([len(text) + 1])
            return layout.pack(_ENCAPSULATION, sec, nanosec, len(text) + 1, text, *rest)
        values = list(found)
        lengths = []
        for i in reversed(self._texts):
            values[i] = text = values[i].encode()
            values.insert(i, len(text) + 1)
            lengths.append(len(text) + 1)
        layout = self._layouts.get(tuple(lengths)) or self._layout(lengths)
        return layout.pack(_ENCAPSULATION, *values)

    def unpack(self, data: bytes) -> Any:
        """Give a record with the fields of the message, as they are named there.

        What follows the last field is of a later version, and left out.

        Raises:
            UnreadableError: the bytes end before its last field, or hold a text that is none.
        """
        try:
            if data[1] != _ENCAPSULATION[1]:  # from a machine that is not little endian
                return deserialize_message(data, self._kind)
            return self._unpack(data)
        except _MALFORMED as error:
            raise unreadable(data, self._kind, error) from None

    def check(self, data: bytes) -> None:
        """Refuse bytes that are not one message of just this version.

        Raises:
            UnreadableError: they are not.
        """
        _check_whole(data, self.pack(self.unpack(data)), self._kind)

    def _unpack(self, data: bytes) -> Any:
        if self._plain:
            (length,) = _LENGTH.unpack_from(data, _FRAME)
            layout = self._layouts.get((length,)) or self._layout_of(data)
            _, sec, nanosec, _, frame, *rest = layout.unpack_from(data)
            return self._record(Header(Stamp(sec, nanosec), frame.decode()), *rest)
        _, *values = self._layout_of(data).unpack_from(data)
        for i in self._texts:
            del values[i]
            values[i] = values[i].decode()
        if not self._headed:
            return self._record(*values)
        sec, nanosec, frame, *rest = values
        return self._record(Header(Stamp(sec, nanosec), frame), *rest)

    def _layout_of(self, data: bytes) -> struct.Struct:
        """Layout of a message, by the lengths of its texts."""
        lengths: list[int] = []
        for _ in self._texts:
            lengths.insert(0, _length(data, self._layout(lengths).size - _LENGTH.size))
        return self._layouts.get(tuple(lengths)) or self._layout(lengths)

    def _layout(self, lengths: list[int]) -> struct.Struct:
        """Layout of a message with texts of these lengths, the last one first; of fewer up to the next length."""
        known = self._layouts.get(tuple(lengths))
        if known is not None:
            return known
        left = list(lengths)
        parts, at = ['<4s'], 0

        def add(code: str, size: int, align: int) -> None:
            nonlocal at
            pad = -at % align
            parts.append('x' * pad + code)
            at += pad + size

        for what in self._types:
            if what != _TEXT:
                size = struct.calcsize('=' + NUMBERS[what])
                add(NUMBERS[what], size, size)
                continue
            add('I', _LENGTH.size, _LENGTH.size)
            if not left:
                break
            length = left.pop()
            add(f'{length - 1}sx', length, 1)
        if len(self._layouts) >= _MOST_LAYOUTS:
            self._layouts.clear()
        made = self._layouts[tuple(lengths)] = struct.Struct(''.join(parts))
        return made


def _length(data: bytes, at: int) -> int:
    """Length of a text; a layout is kept for each, so one that the message cannot hold is refused first."""
    length: int = _LENGTH.unpack_from(data, at)[0]
    if not 0 < length <= len(data):
        raise ValueError(f'a text of {length} bytes')
    return length


@cache
def wire_of(kind: Any) -> Wire | None:
    """Give the wire of a kind of messages; None where it holds more than numbers, texts and a header."""
    fields: list[tuple[str, str]] = []
    described = list(kind.get_fields_and_field_types().items())
    headed = bool(described) and described[0] == ('header', 'std_msgs/Header')
    if headed:
        fields += [*_HEADER, ('header.frame_id', _TEXT)]
        described = described[1:]
    if not all(what in NUMBERS or what == _TEXT for _, what in described):
        return None
    fields += described
    return Wire(kind, fields, headed) if fields else None


def checker_of(kind: Any) -> Callable[[bytes], None]:
    """Give what refuses bytes that are not one message of this kind: it raises `UnreadableError`."""
    wire = wire_of(kind)
    if wire is not None:
        return wire.check

    def check(data: bytes) -> None:
        try:
            message = deserialize_message(data, kind)
            again = serialize_message(message)
        except _MALFORMED as error:
            raise unreadable(data, kind, error) from None
        # a text with the sign that stands in the bytes, too, was sent with it; padding may hold any bytes
        if any(_REPLACED in text and text.encode() not in data for text in _texts_in(message)):
            raise unreadable(data, kind, 'a text that is none')
        _check_whole(data, again, kind)

    return check


def _texts_in(value: Any) -> Iterator[str]:
    """Give all texts of a message or a record, in their order."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, list | tuple):
        for element in value:
            yield from _texts_in(element)
    elif hasattr(value, '__slots__'):
        for slot in value.__slots__:
            yield from _texts_in(getattr(value, slot))


def unreadable(data: bytes, kind: Any, why: object) -> UnreadableError:
    """Give the error."""
    first = str(why).partition('\n')[0]
    return UnreadableError(f'{len(data)} bytes that are no {kind.__name__} ({first})')


def _check_whole(data: bytes, again: bytes, kind: Any) -> None:
    """Refuse bytes that are longer or shorter than what they say, or in which a text does not end with its zero.

    Some readers of bags stop at the first text without its zero, so the rest of the bag would be lost to them.

    Args:
        data: what has arrived.
        again: what the middleware makes of its fields.
        kind: class of the message.

    Raises:
        UnreadableError: they are not one message of this kind.
    """
    if abs(len(data) - len(again)) >= _LENGTH.size:  # a message may be filled up to a whole word
        raise unreadable(data, kind, f'{len(again)} would be')
    try:
        spans = spans_of_texts(data, kind)
    except ValueError as error:
        raise unreadable(data, kind, error) from None
    if any(data.find(0, begin, end) != end - 1 for begin, end in spans):
        raise unreadable(data, kind, 'a text that does not end with its zero')


def blank(kind: Any) -> Any:
    """Give an object with the attributes of a message of this kind and their defaults, to be filled again and again.

    It takes the header of a record, and checks no types.
    """
    message = kind()
    return SimpleNamespace(
        **{name: getattr(message, name) for name in message.get_fields_and_field_types()}
    )
