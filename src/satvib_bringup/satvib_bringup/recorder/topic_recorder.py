# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the recorder, and what it keeps of a topic."""

from dataclasses import dataclass
from typing import Any

from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from satvib_common.errors import SatvibError
from satvib_common.schema import Fixed, Schema, param
from satvib_common.sequence import SequenceTracker

from satvib_bringup.recorder.bag_sink import Channel
from satvib_bringup.recorder.message_text import definition, type_hash

DEPTH = 1000
_FOR_EVER = QosTime(9223372036, 854775807)


@dataclass(frozen=True, kw_only=True)
class RecorderParameters(Schema):
    """Where to, and what for."""

    folder: str = param(
        '', 'folder of the bag; empty: satvib-<date>-<time> here', read_only=Fixed.START
    )
    struts: tuple[str, ...] = param(
        (), 'names of the struts; empty: as the schedule says', read_only=Fixed.START
    )
    depth: int = param(
        20000, 'messages per topic that may wait for this node', minimum=1, read_only=Fixed.START
    )
    lockstep: bool = param(
        False,
        'nothing is in a hurry, so this process does not step back for others',
        read_only=Fixed.START,
    )
    report: str = param(
        '', 'JSON file for what was written and lost; empty: none', read_only=Fixed.START
    )
    custom_keys: tuple[str, ...] = param(
        (), 'names of texts stored in the bag', read_only=Fixed.START
    )
    custom_values: tuple[str, ...] = param((), 'those texts', read_only=Fixed.START)

    def check(self) -> None:
        """Every text has a name."""
        if len(self.custom_keys) != len(self.custom_values):
            raise SatvibError(
                f'custom_keys: {len(self.custom_keys)} names for {len(self.custom_values)} texts'
            )


class Topic:
    """One recorded topic."""

    def __init__(self, name: str, kind: str, is_sampled: bool) -> None:
        self.name, self.kind, self.is_sampled = name, kind, is_sampled
        # looked up now, because the first message is no time for it
        self.text = definition(kind)
        self.hash = type_hash(kind, self.text)
        self.channel: Channel | None = None
        self.sequence = SequenceTracker()
        self.first: int | None = None
        self.count = 0

    def open(self, reliability: str, durability: str) -> Channel:
        """Make the bag's channel; reliability and durability as the writer offers them."""
        qos = Qos(
            QosHistory.KEEP_LAST, DEPTH, QosReliability[reliability], QosDurability[durability],
            _FOR_EVER, _FOR_EVER, QosLiveliness.AUTOMATIC, _FOR_EVER, avoid_ros_namespace_conventions=False,
        )  # fmt: skip
        self.channel = Channel(self.name, self.kind, self.text, self.hash, qos)
        return self.channel

    def saw(self, sequence: int) -> None:
        """Count a message of a sample."""
        if self.first is None:
            self.first = sequence
        self.sequence.classify(sequence)
        self.count += 1

    def report(self) -> dict[str, Any]:
        """What was written; `lost` counts gaps, which the model's topic has by design."""
        found: dict[str, Any] = {'type': self.kind, 'count': self.count}
        if self.is_sampled:
            found |= {
                'first': self.first,
                'last': self.sequence.last,
                'gaps': self.sequence.lost,
                'repeated': self.sequence.repeats,
                'restarts': self.sequence.restarts,
            }
        return found
