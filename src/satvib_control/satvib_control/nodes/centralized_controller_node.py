# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `centralized_controller`: carries messages to and from `CentralizedCore`.

It runs in the place of all strut controllers and uses their topics. It listens to the acceleration of every strut,
waits until a sample of all of them is there, and publishes voltage and controller state of every strut.
"""

from collections import deque
from functools import partial

from rclpy.qos import QoSProfile
from satvib_common.phases import PhasePlan
from satvib_common.ros.delivery.endpoints import Input
from satvib_common.ros.main import run_node
from satvib_common.ros.qos import wanted
from satvib_common.struts.names import strut_names

from satvib_control.core.centralized import CentralizedCore
from satvib_control.laws.centralized.parameters import CentralizedParameters
from satvib_control.nodes.awaited import awaited_input
from satvib_control.nodes.controller_node import ControllerNode
from satvib_control.nodes.sample_gatherer import SampleGatherer
from satvib_msgs.msg import Schedule, StrutAcceleration


class CentralizedControllerNode(ControllerNode[CentralizedParameters]):
    """Controls all struts."""

    stopped = 'every strut goes to 0 V from the next sample on, until reset'

    def __init__(self) -> None:
        super().__init__('centralized_controller', CentralizedParameters)

    def configure(self) -> None:
        """Build the core and the queue of whole samples."""
        p = self.parameters
        self.names = strut_names(p.struts)
        self.serve(
            CentralizedCore(p, (p.struts,)),
            [((i,), f'{name}/') for i, name in enumerate(self.names)],
        )
        self.gatherer: SampleGatherer[StrutAcceleration] = SampleGatherer(p.struts)
        self.waiting: deque[tuple[int, list[StrutAcceleration]]] = deque()
        self.newest = [-1] * p.struts  # by strut, the sample that came last

    def activate(self) -> None:
        """Listen to all struts and to the schedule."""
        self.listen_to(Schedule, 'schedule', self.on_schedule, wanted(whole=True))
        self.pace.begin()

    def hear(self, qos: QoSProfile) -> list[Input]:
        """Listen to the sensors of all struts."""
        return [
            self.listen_to(
                StrutAcceleration, f'{name}/acceleration', partial(self._on_acceleration, i), qos
            )
            for i, name in enumerate(self.names)
        ]

    @property
    def samples_waiting(self) -> int:
        """How many whole samples wait for the schedule."""
        return len(self.waiting)

    def awaits(self) -> str:
        """Give what is missing for the next answer."""
        return awaited_input(self, [f'{name}/acceleration' for name in self.names], 'schedule')

    def work(self, plan: PhasePlan) -> None:
        """Answer every sample that is there for all struts."""
        while self.waiting:
            self.answer(*self.waiting.popleft(), plan)

    def _on_acceleration(self, strut_index: int, message: StrutAcceleration) -> None:
        fits = self.fit.takes(f'{self.names[strut_index]} acceleration', message.sample_period)
        if not fits or not self.pace.see(message.pace, message.sequence):
            return
        odd, self.newest[strut_index] = (
            message.sequence <= self.newest[strut_index],
            message.sequence,
        )
        self.sources.see_sample(odd, f'{self.names[strut_index]}/acceleration')
        whole = self.gatherer.add(strut_index, message.sequence, message)
        if whole is not None:
            self.waiting.append((message.sequence, whole))
            self.proceed()


def main() -> None:
    """Run the node."""
    run_node(CentralizedControllerNode)


if __name__ == '__main__':
    main()
