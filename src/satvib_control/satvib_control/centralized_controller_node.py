# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `centralized_controller`: carries messages to and from `CentralizedCore`.

It runs in place of all strut controllers, and speaks on their topics: it listens to the acceleration of every strut,
answers when a sample of all of them is there, and publishes every strut's voltage and controller state.
"""

import sys
import time
from collections import deque
from functools import partial

import numpy as np
from satvib_common.phases import Phase, PhasePlan
from satvib_common.ros.convert import check_period, nanoseconds, plan_of
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted

from satvib_control.centralized_core import CentralizedCore
from satvib_control.centralized_parameters import CentralizedParameters
from satvib_control.controller import ControllerOutput
from satvib_control.gathering import Gathering
from satvib_msgs.msg import ControllerState, Schedule, StrutAcceleration, VcaVoltage

_STANDBY = PhasePlan((Phase.STANDBY,), (0,))


class CentralizedControllerNode(SatvibNode[CentralizedParameters]):
    """Controls all struts."""

    def __init__(self) -> None:
        super().__init__('centralized_controller', CentralizedParameters)

    def make(self) -> None:
        """Build the core and the messages that are refilled."""
        p = self.parameters
        self.names = [f'strut_{i + 1}' for i in range(p.struts)]
        self.core = CentralizedCore(p, (p.struts,))
        self.plan: PhasePlan | None = None
        self.gathering: Gathering[StrutAcceleration] = Gathering(p.struts)
        self.waiting: deque[tuple[int, list[StrutAcceleration]]] = deque()
        self.last: ControllerOutput | None = None
        self.last_stamp: int | None = None
        self.slowest = 0.0
        self.voltages = [VcaVoltage() for _ in self.names]
        self.states = [ControllerState(law=p.law) for _ in self.names]
        self.voltage_out = [self.publish_on(VcaVoltage, f'{n}/voltage') for n in self.names]
        self.state_out = [
            self.publish_on(ControllerState, f'{n}/controller_state') for n in self.names
        ]

    def begin(self) -> None:
        """Listen to all struts and to the schedule."""
        qos = wanted(whole=self.parameters.lockstep)
        self.listen_to(Schedule, 'schedule', self._on_schedule, wanted(whole=True))
        for i, name in enumerate(self.names):
            self.listen_to(
                StrutAcceleration, f'{name}/acceleration', partial(self._on_acceleration, i), qos
            )

    def end(self) -> None:
        """Leave the struts at 0 V, unless the run is over anyway."""
        last = self.last
        over = self.plan is not None and last is not None and last.sequence == self.plan.end - 1
        if last is None or over:
            return
        for voltage, publisher in zip(self.voltages, self.voltage_out, strict=True):
            if voltage.voltage != 0.0:
                voltage.voltage = 0.0
                publisher.publish(voltage)

    def changed(self, parameters: CentralizedParameters) -> None:
        """Hand new settings to the core."""
        self.core.apply(parameters)

    def stop(self) -> str:
        """Latch 0 V."""
        self.core.stop()
        return 'every strut goes to 0 V from the next sample on, until reset'

    def reset(self) -> str:
        """Release faults."""
        self.core.reset()
        return 'faults are released'

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give what a person wants to know first."""
        last, slowest = self.last, self.slowest
        self.slowest = 0.0
        if last is None:
            return 'no acceleration of all struts yet', {'samples waiting': len(self.waiting)}
        told = {last.reason_text((i,)) for i in range(len(self.names))} - {''}
        figures = {
            'sequence': last.sequence,
            'phase': last.phase.name,
            'law': last.law,
            'samples waiting': len(self.waiting),
            'samples lost': last.missed_samples,
            'slowest step [s]': slowest,
        }
        return '; '.join(sorted(told)), figures

    def _on_schedule(self, message: Schedule) -> None:
        check_period('schedule', message.sample_period, self.parameters.sample_rate)
        self.plan = plan_of(message)
        self._work()

    def _on_acceleration(self, strut: int, message: StrutAcceleration) -> None:
        if message.sequence == 0 or self.last is None:
            check_period(
                f'{self.names[strut]} acceleration', message.sample_period,
                self.parameters.sample_rate,
            )  # fmt: skip
        whole = self.gathering.add(strut, message.sequence, message)
        if whole is not None:
            self.waiting.append((message.sequence, whole))
            self._work()

    def _work(self) -> None:
        """Answer every sample that is there for all struts."""
        while self.waiting and (self.plan is not None or not self.parameters.lockstep):
            self._answer(*self.waiting.popleft(), self.plan or _STANDBY)

    def _answer(self, k: int, samples: list[StrutAcceleration], plan: PhasePlan) -> None:
        start = time.perf_counter()
        upper, lower = (
            np.array([getattr(m, name) for m in samples]) for name in ('upper', 'lower')
        )
        output = self.core.step(k, plan, upper, lower)
        for i, (v, sample) in enumerate(zip(self.voltages, samples, strict=True)):
            v.header, v.sequence = sample.header, k
            v.voltage = float(output.voltage[i])
            v.saturated, v.fault = bool(output.saturated[i]), bool(output.fault[i])
            self.voltage_out[i].publish(v)
        self.last = output
        stamp = nanoseconds(samples[0].header.stamp)
        step = 0.0 if self.last_stamp is None else (stamp - self.last_stamp) * 1e-9
        self.last_stamp = stamp
        spent = time.perf_counter() - start
        self.slowest = max(self.slowest, spent)
        for i, (s, sample) in enumerate(zip(self.states, samples, strict=True)):
            s.header = sample.header
            for name, value in output.fields((i,)).items():
                setattr(s, name, value)
            s.time_step, s.compute_time = step, spent
            self.state_out[i].publish(s)


def main() -> int:
    """Run the node."""
    return run_node(CentralizedControllerNode)


if __name__ == '__main__':
    sys.exit(main())
