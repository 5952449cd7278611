# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `strut_identifier`: carries messages to and from `IdentifierCore`.

Sample k of the acceleration is paired with the voltage of sample k - delay that the coil got (see `voltage_pairing`).
The samples of `plant_sim` and `daq_bridge` say what that was; then the node needs no voltage from the controller. Of
other sources it takes the voltage that was asked for. In lockstep it waits for the schedule and for what it needs;
the samples say whether it is in lockstep (`satvib_common.ros.loop.pace`).

When the model is published is in `model_times`. After the last sample that it estimates with, the node hears nothing
more: it ends its subscriptions and costs nothing, until a new schedule or another source of samples is there.
"""

import math

import numpy as np
from satvib_common.phases import Phase, PhasePlan
from satvib_common.ros.convert import fill, set_header
from satvib_common.ros.delivery.endpoints import Input
from satvib_common.ros.fit import Fit
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.ros.schedule_gate import ScheduleGate
from satvib_common.sequence import Arrival, SequenceTracker
from satvib_common.signals.readings import ABSURD, possible
from satvib_common.struts.applied import CHANGED

from satvib_ident.identifier import Identification, IdentifierCore
from satvib_ident.model_times import ModelTimes
from satvib_ident.nodes.awaited import awaited
from satvib_ident.nodes.biases import Biases
from satvib_ident.nodes.hearing import Hearing
from satvib_ident.nodes.voltage_pairing import VoltagePairing
from satvib_ident.parameters import IdentifierParameters
from satvib_ident.rehearsal import rehearse
from satvib_msgs.msg import ControllerState, IirParameters, Schedule, StrutAcceleration, VcaVoltage

_GATHER, _LOOK = 0.005, 0.1  # s
_NEAR = 9  # samples


class StrutIdentifierNode(SatvibNode[IdentifierParameters]):
    """Identifies one strut."""

    rank = 1
    awaits = awaited

    def __init__(self) -> None:
        super().__init__('strut_identifier', IdentifierParameters)

    def configure(self) -> None:
        """Build the core and the message that is refilled."""
        p = self.parameters
        if not self.in_lockstep:
            rehearse(IdentifierCore(p))
        self.core = IdentifierCore(p)
        self.times: ModelTimes | None = None
        self.hearing = Hearing(
            self, self._on_voltage, self._on_acceleration,
            lambda: self.pairing.set_wait(self.in_lockstep), lambda: self.times is not None,
        )  # fmt: skip
        run, quiet = self._run_is_on, self.hearing.is_quiet
        self.gate = ScheduleGate(self, self.shared('schedule'), p.sample_rate, run, quiet=quiet)
        self.fit = Fit(self, p.sample_rate, run)
        self.phases = frozenset(Phase[name] for name in p.estimate_in)
        self.core.tracker = SequenceTracker(confirm=True, zero_restarts=self.in_lockstep)
        self.pairing: VoltagePairing[StrutAcceleration] = VoltagePairing(
            p.delay, self.in_lockstep, self.core.tracker, p.sample_rate
        )
        self.message = IirParameters(sample_period=p.dt, delay=p.delay)
        self.publisher = self.publish_on(IirParameters, 'identified_model')
        self.biases = Biases()
        self.states: Input | None = None

    def activate(self) -> None:
        """Listen to the strut and to the schedule."""
        self.listen_to(Schedule, self.shared('schedule'), self._on_schedule, wanted(whole=True))
        self.hearing.begin()

    def deactivate(self) -> None:
        """The base ends the subscriptions."""
        self.hearing.forget()
        self.states = None

    def tick(self) -> float:
        """While the node hears nothing, look now and then whether there is another source of samples."""
        if not self.hearing.on and self.hearing.is_another_source():
            self.hearing.begin()
        return _LOOK if not self.hearing.on else super().tick()

    def pause(self) -> float:
        """In lockstep messages gather until a hand-over is near, which saves wake-ups."""
        times, last = self.times, self.core.tracker.last
        if not self.hearing.on or times is None or last is None or not self.in_lockstep:
            return 0.0
        plan, period = times.plan, self.parameters.model_period
        near = any(plan.is_hand_over(k, period) for k in range(last, last + _NEAR))
        return 0.0 if near else _GATHER

    def reset(self) -> str:
        """Start the estimate again."""
        self.core.reset()
        return 'the estimate starts again'

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give the counts of the core."""
        samples, waiting = self.core.tracker, len(self.pairing)
        figures: dict[str, object] = {
            'sequence': -1 if samples.last is None else samples.last, 'samples waiting': waiting,
            'samples without voltage': self.pairing.unknown,
        }  # fmt: skip
        figures |= {name: int(np.max(value)) for name, value in self.core.counters.items()}
        return f'{samples.lost} samples lost' if samples.lost else '', figures

    def _on_schedule(self, message: Schedule) -> None:
        if (plan := self.gate.take(message)) is not None:
            self.times = ModelTimes(plan, self.phases, self.parameters.model_period)
            self.hearing.begin()
            self._work()

    def _run_is_on(self) -> bool:
        last = self.core.tracker.last
        if self.times is None or last is None:
            return False
        if not self.hearing.on:  # the run goes on without this node
            return self.hearing.is_same_source()
        return not (end := self.times.plan.end) or last < end - 1

    def _on_voltage(self, message: VcaVoltage) -> None:
        self.pairing.add_voltage(message.sequence, possible(message.voltage, ABSURD))
        self._work()

    def _on_acceleration(self, message: StrutAcceleration) -> None:
        if not self.fit.takes(f'{self.strut} acceleration', message.sample_period):
            return
        arrival = self.pairing.add_sample(message.sequence, message)
        if arrival in {Arrival.FIRST, Arrival.RESTART}:
            self.biases.begin()
        if message.applied_state and arrival not in {Arrival.REPEAT, Arrival.STRAY}:
            self._take_applied(message)
        self._work()

    def _take_applied(self, message: StrutAcceleration) -> None:
        if self.parameters.delay > 0:
            self.pairing.add_applied(message.sequence - 1, possible(message.applied, ABSURD))
            self.hearing.need_no_voltages()
        elif message.applied_state >= CHANGED:
            self.pairing.add_applied(message.sequence, math.nan)

    def _on_state(self, message: ControllerState) -> None:
        if self.states is not None and self.biases.awaited:
            self.core.know_bias(np.asarray(self.biases.take(message)))
            self.forget(self.states)
            self.states = None

    def _work(self) -> None:
        """Process every sample that has all it needs."""
        if self.times is not None or not self.in_lockstep:
            for sample, voltage, arrival in self.pairing.pairs():
                self._identify(sample, voltage, arrival)

    def _identify(self, sample: StrutAcceleration, voltage: float, arrival: Arrival) -> None:
        k, times = sample.sequence, self.times
        phase = Phase.STANDBY if times is None else self._phase(sample, times.plan)
        upper, clipped = possible(sample.upper, ABSURD), np.asarray(sample.upper_clipped)
        found = self.core.step(k, phase, np.asarray(upper), np.asarray(voltage), arrival, clipped)
        if times is None:
            return
        if times.publishes(k):
            self._publish(sample, found, times.next_after(k))
        if self.hearing.on and times.is_over(k):
            self.hearing.cease()

    def _phase(self, sample: StrutAcceleration, plan: PhasePlan) -> Phase:
        """The phase of a sample; nothing is estimated before the bias is known."""
        self.biases.see(sample, plan)
        if not self.biases.awaited:
            return plan.at(sample.sequence)
        if self.states is None:
            qos = wanted(whole=False)
            self.states = self.listen_to(ControllerState, 'controller_state', self._on_state, qos)
        return Phase.STANDBY

    def _publish(self, sample: StrutAcceleration, found: Identification, after: int) -> None:
        m = self.message
        set_header(m, sample.header)
        m.sequence = sample.sequence
        fill(m, found.figures())
        m.next_sequence, m.bias_lower = after, self.biases.lower
        self.publisher.publish(m)


def main() -> None:
    """Run the node."""
    run_node(StrutIdentifierNode)


if __name__ == '__main__':
    main()
