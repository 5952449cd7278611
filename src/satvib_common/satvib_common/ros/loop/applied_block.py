# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the coils really got, for people: block by block, and at once when a state changes.

The nodes of the loop take it from the samples, so nothing is filled in while nobody reads this topic.
"""

from array import array
from collections.abc import Callable, Sequence
from typing import Any

from satvib_common.ros.convert import set_stamp


class AppliedBlocks:
    """The blocks of all struts.

    Args:
        names: of the struts.
        kind: of the messages, VoltageApplied.
        publish_on: makes a publisher of a kind, for a topic.
        size: samples of a block.
    """

    def __init__(
        self, names: Sequence[str], kind: Any, publish_on: Callable[..., Any], size: int
    ) -> None:
        self._size = size
        self._messages = messages = [kind() for _ in names]
        self._outputs = [publish_on(kind, f'{n}/voltage_applied', spared=True) for n in names]
        for name, message in zip(names, messages, strict=True):
            message.header.frame_id = name
        self._count = 0
        self._read = [False] * len(messages)
        self._states = [-1] * len(messages)
        self._reasons = [''] * len(messages)

    def add(
        self, voltages: Any, states: Any, reasons: Sequence[str], sequence: int, stamp: int
    ) -> None:
        """Take what every coil got at the end of a sample's period.

        Args:
            voltages, states: (struts) V, and an `Applied`.
            reasons: (struts) why it is not what was asked for.
            sequence, stamp: of the sample; ns.
        """
        if self._count == 0:
            self._read = [out.is_read() for out in self._outputs]
        self._count += 1
        over = self._count >= self._size
        for i, m in enumerate(self._messages):
            state = int(states[i])
            news, self._states[i] = state != self._states[i], state
            if not self._read[i]:
                continue
            if not m.voltages:
                m.sequence = sequence
                set_stamp(m.header.stamp, stamp)
            m.voltages.append(float(voltages[i]))
            m.states.append(state)
            self._reasons[i] = reasons[i]
            if news or over:
                self._send(i)
        self._count = 0 if over else self._count

    def flush(self) -> None:
        """Publish what has been gathered."""
        for i, m in enumerate(self._messages):
            if m.voltages:
                self._send(i)

    def _send(self, i: int) -> None:
        m = self._messages[i]
        m.voltage, m.state, m.reason = m.voltages[-1], m.states[-1], self._reasons[i]
        m.samples = len(m.voltages)
        self._outputs[i].publish(m)
        m.voltages, m.states = array('d'), array('B')
