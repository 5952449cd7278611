# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What every controller node does: schedule, settings, services, diagnostics, and answering samples of its struts.

Whether it is in lockstep is said by the samples (`satvib_common.ros.loop.pace`), and by the parameter until then.
The voltages are published first. The state follows: in lockstep for every sample, in real time once in `state_period`
and whenever phase, fault or reason change. When a sample is answered, and with which model, is up to the node of each
kind.
"""

import time
from abc import abstractmethod
from collections.abc import Sequence
from typing import TypeVar

from rclpy.qos import QoSProfile
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_common.ros.convert import fill
from satvib_common.ros.delivery.endpoints import Input
from satvib_common.ros.delivery.wire import blank
from satvib_common.ros.fit import Fit
from satvib_common.ros.loop.pace import PaceFollower
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.schedule_gate import ScheduleGate
from satvib_common.sequence import Arrival

from satvib_control.core.controller import ControllerCore, ControllerOutput
from satvib_control.core.parameters import state_every
from satvib_control.core.reception import readings_of, received_of
from satvib_control.core.rehearsal import rehearse
from satvib_control.nodes.change_log import ChangeLog
from satvib_control.nodes.source_watch import SourceWatch
from satvib_control.nodes.state_report import StateReport
from satvib_control.parameters import ControllerParameters
from satvib_msgs.msg import Schedule, StrutAcceleration, VcaVoltage

P = TypeVar('P', bound=ControllerParameters)
Index = tuple[int, ...]
# without a schedule
_STANDBY = PhasePlan((Phase.STANDBY,), (0,))
_CONTROL = PhasePlan((Phase.CONTROL,), (0,))
_PATIENCE = 1.0  # s, for the schedule of a run that is on


class ControllerNode(SatvibNode[P]):
    """Controls one strut or all."""

    stopped = '0 V from the next sample on, until reset'

    def serve(self, core: ControllerCore, struts: Sequence[tuple[Index, str]]) -> None:
        """Keep the core; make the messages that are refilled and their publishers.

        Args:
            core: gives the voltages.
            struts: for each, its place in the arrays of the core, and the prefix of the names of its topics.
        """
        if not self.in_lockstep:
            rehearse(type(core)(self.parameters, core.shape))
        self.core, self.places = core, [place for place, _ in struts]
        self.offer('hold')
        self.offer('release')
        self.plan: PhasePlan | None = None
        self.patient_until = time.monotonic() + _PATIENCE
        rate, on, acts = self.parameters.sample_rate, self.run_is_on, self.is_acting
        self.last: ControllerOutput | None = None
        names = [name for _, name in struts]
        self.voltages = [blank(VcaVoltage) for _ in names]
        self.voltage_out = [self.publish_on(VcaVoltage, f'{name}voltage') for name in names]
        self.report = StateReport(self.publish_on, names, self.places, 1)
        self.fit, quiet = Fit(self, rate, acts), self.report.is_quiet
        self.gate = ScheduleGate(self, self.shared('schedule'), rate, on, quiet=quiet, acts=acts)
        self.sources = SourceWatch(self, names)
        self.changes = ChangeLog(self.get_logger(), self.places, self.sources.latched)
        topic, expected = f'{names[0]}acceleration', lambda: self.plan is not None
        self.pace = PaceFollower(self, topic, self.hear, self.follow_pace, expected)
        ControllerNode.follow_pace(self)

    @abstractmethod
    def hear(self, qos: QoSProfile) -> list[Input]:
        """Make the subscriptions to the samples."""

    def follow_pace(self) -> None:
        """Work as `in_lockstep` says now."""
        self.report.every = state_every(self.parameters, self.in_lockstep)

    @abstractmethod
    def work(self, plan: PhasePlan) -> None:
        """Answer the samples that have all they need."""

    @property
    @abstractmethod
    def samples_waiting(self) -> int:
        """How many samples wait for what they need."""

    def proceed(self) -> None:
        """Answer what can be answered: in lockstep nothing before there is a plan.

        A node that joins a run in real time gives the schedule, which comes on a topic of its own, a moment to arrive.
        """
        p = self.parameters
        plan = self.plan or (_CONTROL if p.control_at_start else None)
        waits = self.in_lockstep or time.monotonic() < self.patient_until
        if plan is not None or not waits:
            self.work(plan or _STANDBY)

    def deactivate(self) -> None:
        """Leave the struts at 0 V, unless the run is over anyway."""
        last = self.last
        over = self.plan is not None and last is not None and last.sequence == self.plan.end - 1
        if last is None or over:
            return
        for voltage, publisher in zip(self.voltages, self.voltage_out, strict=True):
            if voltage.voltage != 0.0:
                voltage.voltage = 0.0
                publisher.publish(voltage)

    def changed(self, parameters: P) -> None:
        """Hand new settings to the core."""
        self.core.apply(parameters)

    def effect_of(self, names: frozenset[str]) -> str:
        """Ask the core."""
        return self.core.effect_of(names)

    def stop(self) -> str:
        """Latch 0 V."""
        self.core.stop()
        return self.stopped

    def hold(self) -> str:
        """Go to 0 V for a while; the law keeps what it knows."""
        self.core.hold()
        return '0 V until release, for 20 s at most'

    def release(self) -> str:
        """Let the law act again."""
        self.core.release()
        return 'the law acts again'

    def reset(self) -> str:
        """Release faults; a SatvibError where one stays, for no reset can give a bias."""
        self.sources.reset()
        if not self.core.reset():
            raise SatvibError(
                'reset: the bias of the upper sensor is not known, the strut stays at 0 V: '
                'start the run again and pass CALIBRATE at rest'
            )
        return 'faults are released'

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give the reasons of all struts, and the figures of the diagnostics."""
        waiting: dict[str, object] = {'samples waiting': self.samples_waiting}
        if self.last is None:
            return '', waiting
        complaint, figures = self.report.diagnose(self.last)
        return self.sources.with_source(complaint), waiting | figures

    def is_at_fault(self) -> bool:
        """Whether 0 V is latched somewhere."""
        return self.last is not None and bool(self.last.fault.any())

    def on_schedule(self, message: Schedule) -> None:
        """Take the schedule, unless it is refused."""
        plan = self.gate.take(message)
        if plan is not None:
            self.plan = plan
            self.proceed()

    def run_is_on(self) -> bool:
        """Whether a sample of the plan was answered, and another one is to come."""
        plan, last = self.plan, self.last
        return (
            plan is not None and last is not None and (not plan.end or last.sequence < plan.end - 1)
        )

    def is_acting(self) -> bool:
        """Whether it answers samples, in a run or without a schedule."""
        return self.run_is_on() or (self.last is not None and not self.report.is_quiet())

    def answer(
        self,
        k: int,
        samples: Sequence[StrutAcceleration],
        plan: PhasePlan,
        arrival: Arrival | None = None,
    ) -> None:
        """Publish voltage and state of every strut for the sample of number k."""
        start = time.perf_counter()
        upper, lower, up, low = readings_of(samples, self.core.shape)
        received = received_of(samples, self.core.shape)
        output = self.core.step(k, plan, upper, lower, arrival, up, low, received)
        for i, (place, sample) in enumerate(zip(self.places, samples, strict=True)):
            v = self.voltages[i]
            v.header, v.sequence = sample.header, k
            fill(v, output.voltages(), place)
            self.voltage_out[i].publish(v)
        self.last = output
        self.report.publish(output, samples, start)
        self.changes.see(output, samples)
