# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `plant_sim`: carries messages to and from a plant, and is the clock of the graph.

Lockstep: sample k of every strut is published; when every strut's voltage with `sequence` k is there, the plant
advances. Stamps are k periods from 0. Real time: samples are due at absolute instants of the steady clock; one that is
overdue is made up for at once, so that the count follows the time. The voltages' arrivals are measured.
"""

import time
from functools import partial

from satvib_common.arrays import Array
from satvib_common.errors import RunError
from satvib_common.ros.convert import sample_stamp
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.ros.schedule_gate import ScheduleGate
from satvib_common.sequence import Rivals
from satvib_common.struts.applied import Pace
from satvib_common.struts.names import strut_names

from satvib_msgs.msg import Schedule, VcaVoltage
from satvib_plant_sim.nodes.arrivals import Arrivals
from satvib_plant_sim.nodes.awaited import awaited, others_in_the_end, others_of, rivals_of
from satvib_plant_sim.nodes.lockstep_answers import ANOTHER_PLANT, Answers
from satvib_plant_sim.nodes.parameters import PlantParameters
from satvib_plant_sim.nodes.plant_messages import PlantOutputs
from satvib_plant_sim.nodes.realtime_commands import Commands
from satvib_plant_sim.nodes.sim_clock import SimClock

_HEAD_START = 0.2  # s from the schedule to sample 0 in real time


class PlantSimNode(SatvibNode[PlantParameters]):
    """Simulates the isolator."""

    awaits = awaited

    def __init__(self) -> None:
        super().__init__('plant_sim', PlantParameters)

    def configure(self) -> None:
        """Build the plant and a set of publishers per strut."""
        p = self.parameters
        self.plant = plant = p.make_plant()
        self.names = names = list(strut_names(plant.struts))
        pace = Pace.LOCKSTEP if p.lockstep else Pace.CLOCK
        block = max(round(p.truth_period / plant.dt), 1)
        self.out = PlantOutputs(self.publish_on, names, plant, pace, block)
        self.arrivals = Arrivals(p.arrival_file)
        self.clock, self.published_at = SimClock(self), 0.0
        rivals, resume = partial(rivals_of, self), p.after_silence == 'resume'
        self.others, self.ahead = partial(others_in_the_end, self), Rivals()
        self.answers = Answers(names, partial(others_of, self), self.others)
        self.commands = Commands(
            names, p.command_timeout, plant.dt, resume, p.return_time, rivals, p.voltage_limit(),
        )  # fmt: skip
        self.k, self.end_at, self.awaited = -1, 0, 0  # sample that is out, end, voltages to come
        self.gate = ScheduleGate(self, 'schedule', 1.0 / plant.dt, lambda: self.k >= 0, self.names)
        self.stamp_of_start = self.overdue = 0
        self.zero: float | None = None  # s of the steady clock: sample 0 in real time
        self.every(0.1, self._watch)

    def cleanup(self) -> None:
        """Remove the publisher of the clock."""
        self.clock.close()

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
        self.out.flush()
        self.arrivals.save(self.overdue)

    def stop(self) -> str:
        """Latch 0 V at every strut."""
        self.commands.stop()
        return 'every strut goes to 0 V and stays there until reset'

    def reset(self) -> str:
        """Release the faults."""
        self.commands.reset()
        return 'faults are released'

    def changed(self, p: PlantParameters) -> None:
        """Take new times."""
        self.commands.apply(p.command_timeout, p.after_silence == 'resume', p.return_time)

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give the counts."""
        figures: dict[str, object] = {'sequence': self.k, 'late samples': self.overdue}
        return self.commands.complaint(), figures | self.commands.counts()

    def is_at_fault(self) -> bool:
        """Whether 0 V is latched somewhere."""
        return bool(self.commands.fault.any())

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
            self._advance(*self.commands.period_over(due, time.monotonic()))
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
            self.commands.is_answered(i, self.answers.has(i, sequence) and voltage != 0.0)
            if self.answers.take(i, sequence, voltage, k):
                self._advance(self.commands.pass_on(self.answers.voltage), None)
            return
        now = time.monotonic()
        self.arrivals.arrived(i, sequence)
        if self.ahead.saw(sequence > k):
            raise RunError(f'{self.names[i]}: {ANOTHER_PLANT}; {self.others(i)}')
        since = max(now - self.zero - k * self.plant.dt, 0.0)
        due = self.zero + (k + 1) * self.plant.dt
        self.commands.take(i, sequence, voltage, now, since, k, min(now, due))
        self.awaited -= sequence == k
        if self.awaited == 0:
            self.out.flush_whole()  # nobody is in a hurry now

    def _advance(self, voltage: Array, arrival: Array | None) -> None:
        """End the period of sample k; the next sample goes out first, because the controllers wait for it."""
        k = self.k
        truth = self.plant.advance(voltage, arrival)
        over = 0 < self.end_at <= k + 1
        if not over:
            self._publish_sample()
        self.out.period(truth, k, self._stamp(k), self.commands, at_once=self.zero is None)
        while self.commands.events:
            self.get_logger().warning(self.commands.events.pop(0))
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
        self.out.sample(sample, stamp, self.commands)
        self.published_at = now = time.monotonic()
        self.clock.publish(stamp, now)

    def _stamp(self, k: int) -> int:
        return self.stamp_of_start + sample_stamp(k, self.plant.dt)

    def _watch(self) -> None:
        """In lockstep, end the run when a voltage does not come."""
        if not self.active or self.zero is not None or self.k < 0:
            return
        silence = time.monotonic() - self.published_at
        self.answers.check(self.k, silence, self.parameters.lockstep_timeout)


def main() -> None:
    """Run the node."""
    run_node(PlantSimNode)


if __name__ == '__main__':
    main()
