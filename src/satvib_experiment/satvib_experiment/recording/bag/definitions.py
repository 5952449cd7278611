# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Messages from bytes, by the definitions that the bag carries, checked against what is needed of them."""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore
from satvib_common.errors import SatvibError

from satvib_experiment.recording.bag.files import BagContent, messages_of

PACKAGE = 'satvib_msgs/msg'
DIAGNOSTICS = 'diagnostic_msgs/msg/DiagnosticArray'
# what a reader cannot do without, with its type; further fields may come and go with the version
_NEEDED = {
    'Schedule': {
        'scenario': 'string', 'seed': 'uint64', 'sample_period': 'float64', 'struts': 'string[]',
        'phases': 'uint8[]', 'first_sequence': 'uint64[]', 'end_sequence': 'uint64',
    },
    'StrutAcceleration': {'sequence': 'uint64', 'upper': 'float64', 'lower': 'float64'},
    'VcaVoltage': {'sequence': 'uint64', 'voltage': 'float64'},
    'IirParameters': {'sequence': 'uint64', 'a': 'float64[]', 'b': 'float64[]'},
    'ControllerState': {'sequence': 'uint64', 'phase': 'uint8'},
    'StrutTruth': {'sequence': 'uint64', 'upper': 'float64[]', 'lower': 'float64[]'},
}  # fmt: skip
_SEPARATOR = '=' * 80 + '\n'
_LONGEST_DEFINITION = 100_000  # characters


class Messages:
    """The messages of a bag, deserialized.

    Args:
        content: what was read of the bag.
        name: of the bag, for the errors.
        recover: leave out the messages that are none; `unreadable` counts them.
    """

    def __init__(self, content: BagContent, name: str, recover: bool = False) -> None:
        self._content, self._name, self._recover = content, name, recover
        self.unreadable = 0

    def of(self, kind: str) -> Iterator[tuple[str, Any]]:
        """Topic and message of every message of a type.

        Raises:
            SatvibError: its definition or a message is damaged.
        """
        raw = list(messages_of(self._content, kind))
        if not raw:
            return
        store = self._store(kind)
        for topic, _, data in raw:
            try:
                message = store.deserialize_cdr(data, kind)
            except Exception as error:  # rosbags raises anything for bytes that are no message
                if not self._recover:
                    raise SatvibError(
                        f'{self._name}: damaged: a message of {topic} is not of type {kind}'
                    ) from error
                self.unreadable += 1
                continue
            yield topic, message

    def _store(self, kind: str) -> Typestore:
        form, text = self._content.definitions.get(kind, ('', ''))
        if not text:
            raise SatvibError(
                f'{self._name}: the bag does not hold the definition of {kind}; record it with a '
                'ROS 2 of Jazzy or later'
            )
        try:
            store = _compiled(kind, form, text)
            fields = {name: _described(what) for name, what in store.fielddefs[kind][1]}
        except Exception as error:  # a parser that meets damaged bytes raises anything
            raise SatvibError(f'{self._name}: damaged: the definition of {kind}') from error
        package, _, short = kind.rpartition('/')
        for name, wanted in _NEEDED.get(short, {}).items() if package == PACKAGE else ():
            if fields.get(name) != wanted:
                what = f'is {fields[name]}, not {wanted}' if name in fields else 'is missing'
                raise SatvibError(
                    f'{self._name}: damaged, or of another satvib: in the definition of {kind}, '
                    f'{name} {what}'
                )
        return store


@lru_cache(maxsize=32)
def _compiled(kind: str, form: str, text: str) -> Typestore:
    if len(text) > _LONGEST_DEFINITION:
        raise ValueError
    store = get_typestore(Stores.EMPTY)
    if form == 'ros2msg':
        store.register(get_types_from_msg(text, kind))
    else:
        parts = [text]
        if text.startswith(f'{_SEPARATOR}IDL: '):  # each part begins with a line that names it
            parts = [part.partition('\n')[2] for part in text.split(_SEPARATOR)[1:]]
        for part in parts:
            store.register(get_types_from_idl(part))
    store.get_msgdef(kind)
    return store


def _described(what: Any) -> str:
    """A field's type as in a .msg file."""
    number, detail = int(what[0]), what[1]
    if number == 1:  # a basic type: its name and length
        return str(detail[0])
    if number == 2:
        return str(detail)
    return f'{_described(detail[0])}[]'
