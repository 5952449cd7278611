# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `supervisor`: carries messages of all struts to `SupervisorCore`, and what it asks to their controllers.

It listens only. What it asks are the services `hold`, `release` and `stop` of the strut controllers; every strut runs
as well without it. After a check it publishes the number of the last sample that is judged on `/supervision`, once
the services have answered. In lockstep controllers with `supervised` wait for that number at the sample after a
check, so what is asked holds from that sample on, as offline.
"""

import time
from collections import deque
from functools import partial

import numpy as np
from satvib_common.errors import RunError
from satvib_common.phases import PhasePlan
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.ros.reporting import QUIET, source_of
from satvib_common.ros.schedule_gate import ScheduleGate
from satvib_common.sequence import Arrival, SequenceTracker
from satvib_common.struts.names import strut_names
from std_msgs.msg import UInt64
from std_srvs.srv import Trigger

from satvib_control.nodes.sample_gatherer import SampleGatherer
from satvib_control.supervision.parameters import SupervisorParameters
from satvib_control.supervision.supervisor import Ask, SupervisorCore, is_checked
from satvib_msgs.msg import Schedule, StrutAcceleration, VcaVoltage

SERVICES = {Ask.HOLD: 'hold', Ask.RELEASE: 'release', Ask.STOP: 'stop'}


class SupervisorNode(SatvibNode[SupervisorParameters]):
    """Watches all struts."""

    def __init__(self) -> None:
        super().__init__('supervisor', SupervisorParameters)

    def configure(self) -> None:
        """Build the core and the publisher."""
        p = self.parameters
        self.names = strut_names(p.struts)
        self.judged_out = self.publish_on(UInt64, 'supervision')
        self.plan: PhasePlan | None = None
        self.heard_at = 0.0  # s of the steady clock
        self.gate = ScheduleGate(
            self, 'schedule', p.sample_rate, self.run_is_on, self.names,
            quiet=lambda: time.monotonic() - self.heard_at > QUIET,
        )  # fmt: skip
        self.asked: list[str] = []
        self.trackers = [
            SequenceTracker(confirm=True, zero_restarts=p.lockstep) for _ in self.names
        ]
        self._begin()

    def _begin(self) -> None:
        p = self.parameters
        self.core = SupervisorCore(p, (p.struts,))
        self.gatherer: SampleGatherer[float] = SampleGatherer(2 * p.struts)
        self.waiting: deque[tuple[int, list[float]]] = deque()
        self.last = -1
        self.pending = 0

    def activate(self) -> None:
        """Listen to all struts and to the schedule."""
        qos = wanted(whole=self.parameters.lockstep)
        self.listen_to(Schedule, 'schedule', self._on_schedule, wanted(whole=True))
        self.clients_made = {}
        for i, name in enumerate(self.names):
            for what in SERVICES.values():
                self.clients_made[i, what] = self.create_client(
                    Trigger, f'{name}/strut_controller/{what}'
                )
            self.listen_to(
                StrutAcceleration, f'{name}/acceleration', partial(self._on_acceleration, i), qos
            )
            self.listen_to(VcaVoltage, f'{name}/voltage', partial(self._on_voltage, i), qos)

    def deactivate(self) -> None:
        """Forget the services."""
        for client in self.clients_made.values():
            self.destroy_client(client)
        self.clients_made.clear()

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give what was asked, and the strikes of each strut."""
        strikes = dict(zip(self.names, self.core.strikes.tolist(), strict=True))
        asked, self.asked = self.asked, []
        return '; '.join(asked), {'sequence': self.last} | {
            f'strikes of {name}': count for name, count in strikes.items()
        }

    def awaits(self) -> str:
        """Give what is missing for the next judgement."""
        if self.plan is None:
            return f'the schedule on {source_of(self, "schedule")}'
        if self.last >= 0:
            return ''
        topics = [f'{name}/{what}' for name in self.names for what in ('acceleration', 'voltage')]
        lacking = [t for t in topics if not self.count_publishers(self.resolve_topic_name(t))]
        return f'samples on {source_of(self, (lacking or topics)[0])}'

    def _on_schedule(self, message: Schedule) -> None:
        self.plan = self.gate.take(message) or self.plan
        self._work()

    def run_is_on(self) -> bool:
        """Whether a sample of the plan was judged, and another one is to come."""
        plan = self.plan
        return plan is not None and self.last >= 0 and (not plan.end or self.last < plan.end - 1)

    def _on_acceleration(self, strut: int, message: StrutAcceleration) -> None:
        arrival = self.trackers[strut].classify(message.sequence)
        if arrival is Arrival.STRAY:
            return
        # of all struts, the first one that starts again begins the new run
        if arrival is Arrival.RESTART and self.last >= 0:
            self._begin()
        self._add(2 * strut, message.sequence, message.upper)

    def _on_voltage(self, strut: int, message: VcaVoltage) -> None:
        self._add(2 * strut + 1, message.sequence, message.voltage)

    def _add(self, stream: int, sequence: int, value: float) -> None:
        whole = self.gatherer.add(stream, sequence, value)
        if whole is not None:
            self.waiting.append((sequence, whole))
            self._work()

    def _work(self) -> None:
        while self.plan is not None and self.waiting:
            k, whole = self.waiting.popleft()
            values = np.array(whole).reshape(-1, 2)
            self.last, self.heard_at = k, time.monotonic()
            asks = self.core.step(k, self.plan, values[:, 0], values[:, 1])
            for i in np.flatnonzero(asks):
                self._ask(int(i), SERVICES[Ask(int(asks[i]))])
            if is_checked(k + 1, self.parameters.sample_rate):
                self._publish_when_answered()

    def _ask(self, strut: int, what: str) -> None:
        """Call a service of a strut's controller.

        Raises:
            RunError: in lockstep, where the service is not there.
        """
        client = self.clients_made[strut, what]
        line = f'{what} {self.names[strut]} at sample {self.last}'
        self.asked.append(line)
        self.get_logger().warning(line)
        if not client.service_is_ready():
            if self.parameters.lockstep:
                raise RunError(f'supervisor: {line}: its controller has no such service')
            return
        self.pending += 1
        client.call_async(Trigger.Request()).add_done_callback(self.guarded(self._on_answer))

    def _on_answer(self, _: object) -> None:
        self.pending -= 1
        self._publish_when_answered()

    def _publish_when_answered(self) -> None:
        if self.pending == 0:
            self.judged_out.publish(UInt64(data=self.last))


def main() -> None:
    """Run the node."""
    run_node(SupervisorNode)


if __name__ == '__main__':
    main()
