# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a controller says besides its voltages: states, and how far it is; nothing is filled in for nobody."""

import math
import time
from collections.abc import Callable, Sequence
from typing import Any

from satvib_common.ros.convert import nanoseconds
from satvib_common.ros.delivery.wire import blank
from satvib_common.ros.qos import offered
from satvib_common.ros.reporting import QUIET

from satvib_control.core.output import ControllerOutput
from satvib_msgs.msg import ControllerState, StrutProgress

_PROGRESS = 0.05  # s of wall time

Index = tuple[int, ...]


class StateReport:
    """The messages of the struts of one controller, refilled.

    Args:
        publish_on: makes a publisher of a kind, for a topic.
        names: of the struts, as prefixes of their topics.
        places: of the struts in the arrays of the core.
        every: samples between two states, may be changed; a change of phase, fault or reason goes out in any case.

    Attributes:
        progress_at: s of the performance counter, of the last progress; 0 before the first sample.
    """

    def __init__(
        self,
        publish_on: Callable[..., Any],
        names: Sequence[str],
        places: Sequence[Index],
        every: int,
    ) -> None:
        self._places, self.every = places, every
        self._outs = [
            (
                publish_on(ControllerState, f'{name}controller_state', spared=True),
                publish_on(StrutProgress, f'{name}progress', offered(1), spared=True),
            )
            for name in names
        ]
        self._states = [blank(ControllerState) for _ in places]
        self._progress = blank(StrutProgress)
        self._shown: list[object] = [None] * len(places)
        self.progress_at = self._slowest = 0.0
        self._last_stamp: int | None = None

    def publish(self, output: ControllerOutput, samples: Sequence[Any], start: float) -> None:
        """Publish what is due of a sample that was begun at `start` of the performance counter."""
        now = time.perf_counter()
        stamp = nanoseconds(samples[0].header.stamp)
        step = 0.0 if self._last_stamp is None else (stamp - self._last_stamp) * 1e-9
        self._last_stamp = stamp
        for i, (place, sample) in enumerate(zip(self._places, samples, strict=True)):
            out = self._outs[i][0]
            if out.is_read() and self._is_due(i, output, place):
                s = self._states[i]
                s.header = sample.header
                vars(s).update(output.fields(place))
                s.time_step, s.compute_time = step, now - start
                s.applied_state = sample.applied_state
                s.applied = sample.applied if sample.applied_state else math.nan
                out.publish(s)
        if now - self.progress_at >= _PROGRESS:
            self.progress_at = now
            self._show_progress(output, samples)
        self._slowest = max(self._slowest, now - start)

    def is_quiet(self) -> bool:
        """Whether no sample was answered for a while."""
        return time.perf_counter() - self.progress_at > QUIET

    def diagnose(self, last: ControllerOutput) -> tuple[str, dict[str, object]]:
        """Give the reasons of all struts in the newest output, and figures of the time since the report before."""
        reasons = {last.reason_text(place) for place in self._places} - {''}
        slowest, self._slowest = self._slowest, 0.0
        return '; '.join(sorted(reasons)), {
            'sequence': last.sequence,
            'phase': last.phase.name,
            'law': last.law,
            'samples lost': last.missed_samples,
            'slowest step [s]': slowest,
        }

    def _is_due(self, i: int, output: ControllerOutput, place: Index) -> bool:
        if self.every == 1:
            return True
        news = (output.phase, bool(output.fault[place]), int(output.reason[place]))
        due = output.sequence % self.every == 0 or news != self._shown[i]
        self._shown[i] = news
        return due

    def _show_progress(self, output: ControllerOutput, samples: Sequence[Any]) -> None:
        m = self._progress
        for place, sample, (_, out) in zip(self._places, samples, self._outs, strict=True):
            if out.is_read():
                m.header, m.sequence, m.phase = sample.header, output.sequence, int(output.phase)
                m.upper_rms = float(output.upper_rms[place])
                out.publish(m)
