# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `strut_controller`: carries messages to and from `ControllerCore`.

It listens to its own strut only. In lockstep a sample waits until the schedule is there and, when it is a hand-over
sample, until the model of the sample before is there; in real time the newest model is taken.
"""

import time
from collections import deque

import numpy as np
from rclpy.qos import QoSProfile
from satvib_common.phases import PhasePlan
from satvib_common.ros.delivery.endpoints import Input
from satvib_common.ros.main import run_node
from satvib_common.ros.qos import wanted
from satvib_common.ros.reporting import source_of
from satvib_common.sequence import Arrival, SequenceTracker
from satvib_ident.models.iir_model import IirModel
from std_msgs.msg import UInt64

from satvib_control.core.controller import ControllerCore
from satvib_control.laws.reasons import ForeignTexts
from satvib_control.nodes.awaited import awaited_input
from satvib_control.nodes.controller_node import ControllerNode
from satvib_control.nodes.model_queue import ModelQueue
from satvib_control.parameters import ControllerParameters
from satvib_control.supervision.supervisor import is_checked
from satvib_msgs.msg import IirParameters, Schedule, StrutAcceleration

# a sample that does not follow those before
_ODD = frozenset({Arrival.REPEAT, Arrival.STRAY, Arrival.RESTART})
# samples that a model looks back; an identifier has at most 120, and a design of 65535 would take seconds
_LONGEST = 1000


class StrutControllerNode(ControllerNode[ControllerParameters]):
    """Controls one strut."""

    def __init__(self) -> None:
        super().__init__('strut_controller', ControllerParameters)

    def configure(self) -> None:
        """Build the core and the queues."""
        p = self.parameters
        self.serve(ControllerCore(p), [((), '')])
        self.waiting: deque[tuple[StrutAcceleration, Arrival]] = deque()
        self.models: ModelQueue[IirParameters] = ModelQueue(p.model_period, wait=self.in_lockstep)
        self.tracker = SequenceTracker(confirm=True, zero_restarts=self.in_lockstep)
        self.tracker.follow(None if self.in_lockstep else self._periods)
        self.supervised = p.supervised and self.in_lockstep
        self.reasons = ForeignTexts()
        self.judged = -1  # the last sample that the supervisor has judged

    def activate(self) -> None:
        """Listen to the strut and to the schedule."""
        self.listen_to(Schedule, self.shared('schedule'), self.on_schedule, wanted(whole=True))
        self._hear_supervisor()
        self.listen_to(IirParameters, 'identified_model', self._on_model, wanted(whole=True))
        self.pace.begin()

    def hear(self, qos: QoSProfile) -> list[Input]:
        """Listen to the sensors of the strut."""
        return [self.listen_to(StrutAcceleration, 'acceleration', self._on_acceleration, qos)]

    def follow_pace(self) -> None:
        """In lockstep wait for the model and the supervisor, too."""
        super().follow_pace()
        self.models.wait = self.tracker.zero_restarts = self.in_lockstep
        self.tracker.follow(None if self.in_lockstep else self._periods)
        before, self.supervised = self.supervised, self.parameters.supervised and self.in_lockstep
        if self.supervised and not before:
            self._hear_supervisor()

    def _periods(self) -> float:
        """The steady clock, in sample periods."""
        return time.monotonic() * self.parameters.sample_rate

    def _hear_supervisor(self) -> None:
        if self.supervised:
            topic = self.shared('supervision')
            self.listen_to(UInt64, topic, self._on_supervision, wanted(whole=True))

    @property
    def samples_waiting(self) -> int:
        """How many samples wait for schedule or model."""
        return len(self.waiting)

    def awaits(self) -> str:
        """Give what is missing for the next answer."""
        found = awaited_input(self, ['acceleration'], self.shared('schedule'))
        if found or not self.waiting or self.plan is None or not self.report.is_quiet():
            return found
        k = self.waiting[0][0].sequence
        if not self._is_judged(k):
            return (
                f'the judgement of sample {k - 1} on {source_of(self, self.shared("supervision"))}'
            )
        return f'the model of sample {k - 1} on {source_of(self, "identified_model")}'

    def work(self, plan: PhasePlan) -> None:
        """Answer every sample that has all it needs."""
        while self.waiting:
            sample, arrival = self.waiting[0]
            if not self._is_judged(sample.sequence):
                return
            ready, model = self.models.take(sample.sequence, plan)
            if not ready:
                return
            if model is not None:
                self._set_model(model, sample.sequence, plan)
            self.waiting.popleft()
            self.answer(sample.sequence, [sample], plan, arrival)
            self._prepare(plan)

    def _prepare(self, plan: PhasePlan) -> None:
        """Between two samples, do what the next one would begin with: its voltage then waits for no design."""
        if (
            self.last is None
            or self.waiting
            or not (self.core.designs_wait or self.models.newest >= 0)
        ):
            return
        k = self.last.sequence + 1
        if plan.is_hand_over(k, self.models.period):
            if self.models.newest != k - 1:
                return  # its model is still to come
            _, model = self.models.take(k, plan)
            if model is not None:
                self._set_model(model, k, plan)
        self.core.prepare(plan.at(k))

    def _is_judged(self, k: int) -> bool:
        """Whether what a supervisor asks from sample k on is known."""
        checked = self.supervised and is_checked(k, self.parameters.sample_rate)
        return not checked or self.judged >= k - 1

    def _on_supervision(self, message: UInt64) -> None:
        self.judged = message.data
        self.proceed()

    def _on_model(self, message: IirParameters) -> None:
        wrong = _wrong_with(message)
        if not self.fit.takes(f'{self.strut} identified_model', message.sample_period, wrong):
            return
        self.sources.see_model(message.sequence, 'identified_model')
        self.core.know_biases(message.bias, message.bias_lower)
        self.models.add(message.sequence, message, self.plan, message.next_sequence)
        self.proceed()
        if self.plan is not None:
            self._prepare(self.plan)

    def _on_acceleration(self, message: StrutAcceleration) -> None:
        fits = self.fit.takes(f'{self.strut} acceleration', message.sample_period)
        if not fits or not self.pace.see(message.pace, message.sequence):
            return
        arrival = self.tracker.classify(message.sequence)
        self.sources.see_sample(arrival in _ODD, 'acceleration')
        if arrival in {Arrival.FIRST, Arrival.RESTART}:
            self.waiting.clear()
            self.judged = -1 if arrival is Arrival.RESTART else self.judged
            self.models.begin(message.sequence, new_run=arrival is Arrival.RESTART)
        if arrival not in {Arrival.REPEAT, Arrival.STRAY}:
            self.waiting.append((message, arrival))
            self.proceed()

    def _set_model(self, m: IirParameters, k: int, plan: PhasePlan) -> None:
        """Take the model with which sample k begins."""
        count = len(m.a) + len(m.b)
        model = IirModel(
            np.frombuffer(m.a), np.frombuffer(m.b), int(m.delay), float(m.sample_period)
        )
        covariance = np.frombuffer(m.covariance).reshape(count, count)
        why = self.reasons.take(m.reason)
        self.core.set_model(model, np.asarray(m.converged), why, covariance)
        self.changes.see_model(k, plan.at(k), m)


def _wrong_with(model: IirParameters) -> str:
    """Why a message holds no model that a controller can use; empty: it does."""
    poles, inputs, found = len(model.a), len(model.b), len(model.covariance)
    if not inputs:
        return 'no coefficient b'
    if max(poles, model.delay + inputs) > _LONGEST:
        return f'{poles} poles, {inputs} coefficients b and a delay of {model.delay}; {_LONGEST} are possible'
    count = poles + inputs
    return '' if found == count * count else f'{found} covariances for {count} parameters'


def main() -> None:
    """Run the node."""
    run_node(StrutControllerNode)


if __name__ == '__main__':
    main()
