# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that are lost, doubled, reordered, delayed, changed or damaged on their way."""

import copy
import random
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

NOTHING: Mapping[str, Any] = MappingProxyType({})
_HEAD = 4  # bytes of encapsulation


class Mangling(NamedTuple):
    """What happens to the messages of a topic.

    Attributes:
        do: pass, lose, double, swap (with the next one) or delay.
        share: of the messages that it happens to, from 0 to 1.
        by: delay, in messages.
        put: new values by field; a list is a turn of values. `header.stamp.sec` is a field, too.
        add: what is added, by field.
        slope: what is added for each message, by field.
        hold: fields that keep the value of the first message.
        damage: of the bytes: cut (a drawn number of them is left) or flip (one bit, drawn); empty: none.
    """

    do: str = 'pass'
    share: float = 1.0
    by: int = 0
    put: Mapping[str, Any] = NOTHING
    add: Mapping[str, float] = NOTHING
    slope: Mapping[str, float] = NOTHING
    hold: tuple[str, ...] = ()
    damage: str = ''

    def as_order(self) -> dict[str, Any]:
        """As plain data, from which `Mangling(**...)` makes the same again."""
        return {k: dict(v) if isinstance(v, Mapping) else v for k, v in self._asdict().items()}


def field_of(message: Any, name: str) -> Any:
    """The value of a field, with dots for what lies inside."""
    for part in name.split('.'):
        message = getattr(message, part)
    return message


def set_field(message: Any, name: str, value: Any) -> None:
    """Set it; whole numbers stay whole, and go round as they do in the message."""
    *path, last = name.split('.')
    for part in path:
        message = getattr(message, part)
    now = getattr(message, last)
    if isinstance(now, int) and not isinstance(now, bool):
        value = int(value) % 2**64
    setattr(message, last, value)


class Mangler:
    """Mangles one message after the other.

    Args:
        mangling: how.
        seed: of its chances.
        serialize: gives the bytes of a message, to be damaged.

    Attributes:
        touched: how many messages it has changed or moved.
    """

    def __init__(
        self, mangling: Mangling, seed: int, serialize: Callable[[Any], bytes] = bytes
    ) -> None:
        self.mangling = mangling
        self.touched = 0
        self._serialize = serialize
        self._chance = random.Random(seed)
        self._kept: list[Any] = []
        self._held: dict[str, Any] = {}

    def take(self, message: Any) -> list[Any]:
        """Take a message; give those that go on now, in order."""
        m = self.mangling
        hit = self._chance.random() < m.share
        if m.do == 'delay':
            self._kept.append(message)
            self.touched += 1
            return [] if len(self._kept) <= m.by else [self._kept.pop(0)]
        if self._kept:  # of a swap
            return [message, self._kept.pop()]
        if not hit:
            return [message]
        self.touched += 1
        if m.do == 'lose':
            return []
        if m.do == 'double':
            return [message, message]
        if m.do == 'swap':
            self._kept.append(message)
            return []
        return [self.change(message)]

    def change(self, message: Any) -> Any:
        """Give a copy with other values, or its bytes with damage."""
        m, turn = self.mangling, max(self.touched - 1, 0)
        changed = copy.deepcopy(message)
        for name, value in m.put.items():
            set_field(changed, name, value[turn % len(value)] if isinstance(value, list) else value)
        for name, value in m.add.items():
            set_field(changed, name, field_of(changed, name) + value)
        for name, value in m.slope.items():
            set_field(changed, name, field_of(changed, name) + value * (turn + 1))
        for name in m.hold:
            set_field(changed, name, self._held.setdefault(name, field_of(message, name)))
        return self._damage(self._serialize(changed)) if m.damage else changed

    def _damage(self, data: bytes) -> bytes:
        at = self._chance.randrange(_HEAD, len(data))
        if self.mangling.damage == 'cut':
            return data[:at]
        flipped = data[at] ^ 1 << self._chance.randrange(8)
        return data[:at] + bytes([flipped]) + data[at + 1 :]

    def end(self) -> list[Any]:
        """Give what is still kept, in order."""
        kept, self._kept = self._kept, []
        return kept
