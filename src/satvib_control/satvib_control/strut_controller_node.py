# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `strut_controller`: carries messages to and from `ControllerCore`.

It listens to its own strut only. In lockstep a sample waits until the schedule is there and, when it is a hand-over
sample, until the model of the sample before is there; in real time the newest model is taken. The voltage is published
before anything else.
"""

import sys
import time
from collections import deque

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_common.ros.convert import check_period, nanoseconds, plan_of
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.sequence import Arrival, SequenceTracker
from satvib_ident.iir_model import IirModel

from satvib_control.controller import ControllerCore, ControllerOutput
from satvib_control.handover import ModelQueue
from satvib_control.parameters import ControllerParameters
from satvib_msgs.msg import (
    ControllerState,
    IirParameters,
    Schedule,
    StrutAcceleration,
    VcaVoltage,
)

_STANDBY = PhasePlan((Phase.STANDBY,), (0,))


class StrutControllerNode(SatvibNode[ControllerParameters]):
    """Controls one strut."""

    def __init__(self) -> None:
        super().__init__('strut_controller', ControllerParameters)

    def make(self) -> None:
        """Build the core and the messages that are refilled."""
        p = self.parameters
        self.core = ControllerCore(p)
        self.plan: PhasePlan | None = None
        self.waiting: deque[StrutAcceleration] = deque()
        self.models: ModelQueue[IirParameters] = ModelQueue(p.model_period, wait=p.lockstep)
        self.tracker = SequenceTracker()
        self.last: ControllerOutput | None = None
        self.last_stamp: int | None = None
        self.slowest = 0.0
        self.voltage = VcaVoltage()
        self.state = ControllerState(law=p.law)
        self.voltage_out = self.publish_on(VcaVoltage, 'voltage')
        self.state_out = self.publish_on(ControllerState, 'controller_state')

    def begin(self) -> None:
        """Listen to the strut and to the schedule."""
        qos = wanted(whole=self.parameters.lockstep)
        self.listen_to(Schedule, self.shared('schedule'), self._on_schedule, wanted(whole=True))
        self.listen_to(IirParameters, 'identified_model', self._on_model, wanted(whole=True))
        self.listen_to(StrutAcceleration, 'acceleration', self._on_acceleration, qos)

    def end(self) -> None:
        """Leave the strut at 0 V, unless the run is over anyway."""
        last = self.last
        over = self.plan is not None and last is not None and last.sequence == self.plan.end - 1
        if last is not None and last.voltage != 0.0 and not over:
            self.voltage.voltage = 0.0
            self.voltage_out.publish(self.voltage)

    def changed(self, parameters: ControllerParameters) -> None:
        """Hand new settings to the core."""
        self.core.apply(parameters)

    def stop(self) -> str:
        """Latch 0 V."""
        self.core.stop()
        return '0 V from the next sample on, until reset'

    def reset(self) -> str:
        """Release faults."""
        self.core.reset()
        return 'faults are released'

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give what a person wants to know first."""
        last, slowest = self.last, self.slowest
        self.slowest = 0.0
        if last is None:
            return 'no acceleration yet', {'samples waiting': len(self.waiting)}
        figures = {
            'sequence': last.sequence,
            'phase': last.phase.name,
            'law': last.law,
            'samples waiting': len(self.waiting),
            'samples lost': last.missed_samples,
            'slowest step [s]': slowest,
        }
        return last.reason_text(), figures

    def _on_schedule(self, message: Schedule) -> None:
        check_period('schedule', message.sample_period, self.parameters.sample_rate)
        self.plan = plan_of(message)
        self._work()

    def _on_model(self, message: IirParameters) -> None:
        check_period(
            f'{self.strut} identified_model', message.sample_period, self.parameters.sample_rate
        )
        self.models.add(message.sequence, message, self.plan)
        self._work()

    def _on_acceleration(self, message: StrutAcceleration) -> None:
        arrival = self.tracker.see(message.sequence)
        if arrival in {Arrival.FIRST, Arrival.RESTART}:
            check_period(
                f'{self.strut} acceleration', message.sample_period, self.parameters.sample_rate
            )
            self.waiting.clear()
            self.models.begin(message.sequence, anew=arrival is Arrival.RESTART)
        if arrival is not Arrival.REPEAT:
            self.waiting.append(message)
            self._work()

    def _work(self) -> None:
        """Answer every sample that has all it needs."""
        while self.waiting and (self.plan is not None or not self.parameters.lockstep):
            plan = self.plan or _STANDBY
            ready, model = self.models.take(self.waiting[0].sequence, plan)
            if not ready:
                return
            if model is not None:
                self._set_model(model)
            self._answer(self.waiting.popleft(), plan)

    def _set_model(self, m: IirParameters) -> None:
        count = len(m.a) + len(m.b)
        if len(m.covariance) != count * count:
            raise SatvibError(
                f'{self.strut} identified_model: {len(m.covariance)} covariances for {count} '
                'parameters'
            )
        model = IirModel(
            np.frombuffer(m.a), np.frombuffer(m.b), int(m.delay), float(m.sample_period)
        )
        covariance = np.frombuffer(m.covariance).reshape(count, count)
        self.core.set_model(model, np.asarray(m.converged), m.reason, covariance)

    def _answer(self, sample: StrutAcceleration, plan: PhasePlan) -> None:
        start = time.perf_counter()
        k = sample.sequence
        output = self.core.step(k, plan, np.asarray(sample.upper), np.asarray(sample.lower))
        v = self.voltage
        v.header, v.sequence = sample.header, k
        v.voltage = float(output.voltage)
        v.saturated, v.fault = bool(output.saturated), bool(output.fault)
        self.voltage_out.publish(v)
        self.last = output
        s = self.state
        s.header = sample.header
        for name, value in output.fields().items():
            setattr(s, name, value)
        stamp = nanoseconds(sample.header.stamp)
        s.time_step = 0.0 if self.last_stamp is None else (stamp - self.last_stamp) * 1e-9
        self.last_stamp = stamp
        s.compute_time = time.perf_counter() - start
        self.slowest = max(self.slowest, s.compute_time)
        self.state_out.publish(s)


def main() -> int:
    """Run the node."""
    return run_node(StrutControllerNode)


if __name__ == '__main__':
    sys.exit(main())
