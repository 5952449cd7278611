# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `plant_sim`: carries messages to and from a plant, and is the clock of the graph.

Lockstep: sample k of every strut is published; when every strut's voltage with `sequence` k is there, the plant
advances. Stamps are k periods from 0. Real time: samples are due at absolute instants of the steady clock; one that is
overdue is made up for at once, so that the count follows the time. The voltages' arrivals are measured.
"""

import math
import time
from functools import partial

import numpy as np
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from satvib_common.arrays import Array
from satvib_common.errors import RunError
from satvib_common.ros.convert import sample_stamp, set_stamp
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.ros.schedule_gate import ScheduleGate
from satvib_common.struts.names import strut_names

from satvib_msgs.msg import Schedule, StrutAcceleration, StrutTruth, VcaVoltage
from satvib_plant_sim.nodes.arrivals import Arrivals
from satvib_plant_sim.nodes.lockstep_answers import Answers
from satvib_plant_sim.nodes.parameters import PlantParameters
from satvib_plant_sim.nodes.plant_messages import StrutMessage
from satvib_plant_sim.nodes.realtime_commands import Commands
from satvib_plant_sim.nodes.truth_block import TruthBlock

_CLOCK_PERIOD = 0.01  # s of wall time between two messages on /clock
_HEAD_START = 0.2  # s from the schedule to sample 0 in real time


class PlantSimNode(SatvibNode[PlantParameters]):
    """Simulates the isolator."""

    def __init__(self) -> None:
        super().__init__('plant_sim', PlantParameters)

    def configure(self) -> None:
        """Build the plant and a set of publishers per strut."""
        p = self.parameters
        self.plant = plant = p.make_plant()
        self.names = names = list(strut_names(plant.struts))
        self.messages = [StrutMessage(i, name, plant.dt) for i, name in enumerate(names)]
        self.samples_out = [self.publish_on(StrutAcceleration, f'{n}/acceleration') for n in names]
        outs = [self.publish_on(StrutTruth, f'{n}/truth', spared=True) for n in names]
        truths = [StrutTruth(fine_period=plant.fine_period) for _ in names]
        self.truth = TruthBlock(names, truths, outs, max(round(p.truth_period / plant.dt), 1))
        self.arrivals = Arrivals(p.arrival_file)
        self.clock_out = self.create_publisher(Clock, '/clock', qos_profile_sensor_data)
        self.clock, self.clock_at, self.published_at = Clock(), 0.0, 0.0
        self.answers = Answers(self.names)
        self.commands = Commands(plant.struts, p.command_timeout, plant.dt)
        self.k, self.end_at, self.awaited = -1, 0, 0  # sample that is out, end, voltages to come
        self.gate = ScheduleGate(self, 'schedule', 1.0 / plant.dt, lambda: self.k >= 0, self.names)
        self.stamp_of_start = self.overdue = 0
        self.zero: float | None = None  # s of the steady clock: sample 0 in real time
        self.every(0.1, self._watch)

    def cleanup(self) -> None:
        """Remove the publisher of the clock."""
        self.destroy_publisher(self.clock_out)

    def activate(self) -> None:
        """Listen; begin with the schedule, or at once."""
        whole = wanted(whole=self.parameters.lockstep)
        self.listen_to(Schedule, 'schedule', self._on_schedule, wanted(whole=True))
        for i, name in enumerate(self.names):
            self.listen_to(VcaVoltage, f'{name}/voltage', partial(self._on_voltage, i), whole)
        if not self.parameters.wait_for_schedule:
            self._set_off()

    def deactivate(self) -> None:
        """Publish and write what has been gathered."""
        self.truth.flush()
        self.arrivals.save(self.overdue)

    def stop(self) -> str:
        """Latch 0 V at every strut."""
        self.commands.latch()
        return 'every strut goes to 0 V and stays there until reset'

    def reset(self) -> str:
        """Release the faults."""
        self.commands.reset()
        return 'faults are released'

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give the counts."""
        at_fault = [n for n, f in zip(self.names, self.commands.fault, strict=True) if f]
        late = {'late voltages': self.commands.late, 'late samples': self.overdue}
        complaint = f'0 V latched at {", ".join(at_fault)}' if at_fault else ''
        complaint = complaint if self.k >= 0 else 'waiting for the schedule'
        return complaint, {'sequence': self.k, **late}

    def tick(self) -> float:
        """In real time do a sample that is due; gives the time to the next, in s."""
        if self.zero is None:
            return 0.1
        due = self.zero + (self.k + 1) * self.plant.dt
        left = due - time.monotonic()
        if left > 0.0:
            return left
        self.overdue += -left > self.plant.dt
        if self.k < 0:
            self._publish_sample()
        else:
            self._advance(*self.commands.period_over(due))
        return 0.0  # voltages that are there come before another sample that is due

    def _on_schedule(self, message: Schedule) -> None:
        plan = self.gate.take(message)
        if plan is not None:
            self.end_at = plan.end
            self._set_off()

    def _set_off(self) -> None:
        if self.k >= 0 or self.zero is not None:
            return
        if self.parameters.lockstep:
            self._publish_sample()
        else:
            self.zero = time.monotonic() + _HEAD_START
            self.stamp_of_start = time.time_ns() + int(_HEAD_START * 1e9)

    def _on_voltage(self, i: int, message: VcaVoltage) -> None:
        k, sequence, voltage = self.k, message.sequence, message.voltage
        if k < 0:
            return  # of a run before
        if self.zero is None:
            if self.answers.take(i, sequence, voltage, k):
                self._advance(np.where(self.commands.fault, 0.0, self.answers.voltage), None)
            return
        now = time.monotonic()
        self.arrivals.arrived(i, sequence)
        if not math.isfinite(voltage):
            text = (
                f'{self.names[i]}: the voltage of sample {sequence} is {voltage}; 0 V until reset'
            )
            self.get_logger().error(text, throttle_duration_sec=1.0)
        since = max(now - self.zero - k * self.plant.dt, 0.0)
        self.commands.take(i, voltage, now, since, late=sequence < k)
        self.awaited -= sequence == k
        if self.awaited == 0:
            self.truth.flush_whole()  # nobody is in a hurry now

    def _advance(self, voltage: Array, arrival: Array | None) -> None:
        """End the period of sample k; the next sample goes out first, because the controllers wait for it."""
        k = self.k
        truth = self.plant.advance(voltage, arrival)
        over = 0 < self.end_at <= k + 1
        if not over:
            self._publish_sample()
        self.truth.add(truth, k, self._stamp(k), at_once=self.zero is None)
        if over:
            self.finish(
                f'{k + 1} samples of {len(self.names)} struts, {(k + 1) * self.plant.dt:g} s; '
                f'late: {self.commands.late} voltages, {self.overdue} samples'
            )

    def _publish_sample(self) -> None:
        sample = self.plant.sample()
        self.k, self.awaited = sample.sequence, len(self.names)
        stamp = self._stamp(self.k)
        self.arrivals.published(self.k)
        for strut, publisher in zip(self.messages, self.samples_out, strict=True):
            publisher.publish(strut.sampled(sample, stamp))
        self.published_at = now = time.monotonic()
        if now - self.clock_at >= _CLOCK_PERIOD:
            self.clock_at = now
            set_stamp(self.clock.clock, stamp)
            self.clock_out.publish(self.clock)

    def _stamp(self, k: int) -> int:
        return self.stamp_of_start + sample_stamp(k, self.plant.dt)

    def _watch(self) -> None:
        """In lockstep, end the run when a voltage does not come."""
        if not self.active or self.zero is not None or self.k < 0:
            return
        limit, k = self.parameters.lockstep_timeout, self.k
        if time.monotonic() - self.published_at > limit:
            raise RunError(
                f'no voltage for sample {k} from {", ".join(self.answers.missing(k))} within '
                f'{limit:g} s; is the controller there, and its identifier?'
            )


def main() -> None:
    """Run the node."""
    run_node(PlantSimNode)


if __name__ == '__main__':
    main()
