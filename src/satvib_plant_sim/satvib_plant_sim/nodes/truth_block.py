# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The truth of several samples in one message for each strut; nobody in the loop waits for it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from satvib_common.ros.convert import doubles, set_stamp

from satvib_plant_sim.plant.observation import Truth

# scalar fields of satvib_msgs/StrutTruth, and the fields that hold them for every sample of the block
_EACH = {
    'stroke': 'strokes',
    'stroke_peak': 'stroke_peaks',
    'force_peak': 'force_peaks',
    'current': 'currents',
}


class TruthBlock:
    """Gathers the truth and publishes it block by block.

    Args:
        names: of the struts.
        messages: a StrutTruth for each, with its fine period.
        outputs: their publishers.
        size: samples of a block.
    """

    def __init__(
        self,
        names: Sequence[str],
        messages: Sequence[Any],
        outputs: Sequence[Any],
        size: int,
    ) -> None:
        self.size = size
        self._messages, self._outputs = messages, outputs
        for name, message in zip(names, messages, strict=True):
            message.header.frame_id = name
        self._waiting: list[Truth] = []
        self._first = self._stamp = 0

    def add(self, truth: Truth, sequence: int, stamp: int, at_once: bool) -> None:
        """Take what happened after a sample.

        Args:
            truth: it.
            sequence, stamp: of the sample; ns.
            at_once: a block that is whole goes out now, and not when `flush_whole` is called.
        """
        self.flush_whole()
        if not self._waiting:
            self._first, self._stamp = sequence, stamp
        self._waiting.append(truth)
        if at_once:
            self.flush_whole()

    def flush_whole(self) -> None:
        """Publish a block that is whole: at the latest before the next sample is added."""
        if len(self._waiting) >= self.size:
            self.flush()

    def flush(self) -> None:
        """Publish what has been gathered."""
        block = self._waiting
        if not block:
            return
        for i, (m, out) in enumerate(zip(self._messages, self._outputs, strict=True)):
            if out.is_read():
                self._fill(m, i, block)
                out.publish(m)
        self._waiting = []

    def _fill(self, m: Any, i: int, block: Sequence[Truth]) -> None:
        set_stamp(m.header.stamp, self._stamp)
        m.sequence, m.samples = self._first, len(block)
        for name in ('upper', 'lower'):
            setattr(m, name, doubles(np.concatenate([getattr(truth, name)[i] for truth in block])))
        for one, each in _EACH.items():
            values = np.array([getattr(truth, one)[i] for truth in block])
            setattr(m, one, float(values[0]))
            setattr(m, each, doubles(values))
