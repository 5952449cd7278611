# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `strut_identifier`: carries messages to and from `IdentifierCore`.

Sample k of the acceleration is paired with the voltage of sample k - delay that the strut's guard applied (see
`voltage_pairing`). In lockstep the node waits for both and for the schedule.

The model is published for every sample of a phase in which it is estimated, and for the sample before a hand-over.
"""

import numpy as np
from satvib_common.phases import Phase, PhasePlan
from satvib_common.ros.convert import check_period, fill
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.ros.schedule_gate import ScheduleGate
from satvib_common.sequence import Arrival, SequenceTracker

from satvib_ident.identifier import Identification, IdentifierCore
from satvib_ident.nodes.voltage_pairing import VoltagePairing
from satvib_ident.parameters import IdentifierParameters
from satvib_msgs.msg import IirParameters, Schedule, StrutAcceleration, VcaVoltage

_GATHER = 0.005  # s
_NEAR = 9  # samples


class StrutIdentifierNode(SatvibNode[IdentifierParameters]):
    """Identifies one strut."""

    def __init__(self) -> None:
        super().__init__('strut_identifier', IdentifierParameters)

    def configure(self) -> None:
        """Build the core and the message that is refilled."""
        p = self.parameters
        self.core = IdentifierCore(p)
        self.plan: PhasePlan | None = None
        self.gate = ScheduleGate(self, self.shared('schedule'), p.sample_rate, self._run_is_on)
        self.phases = frozenset(Phase[name] for name in p.estimate_in)
        self.core.tracker = SequenceTracker(confirm=True, zero_restarts=p.lockstep)
        self.pairing: VoltagePairing[StrutAcceleration] = VoltagePairing(
            p.delay, p.lockstep, self.core.tracker
        )
        self.message = IirParameters(sample_period=p.dt, delay=p.delay)
        self.publisher = self.publish_on(IirParameters, 'identified_model')

    def activate(self) -> None:
        """Listen to the strut and to the schedule."""
        qos = wanted(whole=self.parameters.lockstep)
        self.listen_to(Schedule, self.shared('schedule'), self._on_schedule, wanted(whole=True))
        self.listen_to(VcaVoltage, 'voltage', self._on_voltage, qos)
        self.listen_to(StrutAcceleration, 'acceleration', self._on_acceleration, qos)

    def pause(self) -> float:
        """In lockstep messages gather until a hand-over is near, which saves wake-ups."""
        plan, last = self.plan, self.core.tracker.last
        if plan is None or last is None or not self.parameters.lockstep:
            return 0.0
        period = self.parameters.model_period
        near = any(plan.is_hand_over(k, period) for k in range(last, last + _NEAR))
        return 0.0 if near else _GATHER

    def reset(self) -> str:
        """Start the estimate again."""
        self.core.reset()
        return 'the estimate starts again'

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give the counts of the core."""
        samples = self.core.tracker
        figures: dict[str, object] = {
            'sequence': -1 if samples.last is None else samples.last,
            'samples waiting': len(self.pairing),
            'samples without voltage': self.pairing.unknown,
        }
        figures |= {name: int(np.max(value)) for name, value in self.core.counters.items()}
        return f'{samples.lost} samples lost' if samples.lost else '', figures

    def _on_schedule(self, message: Schedule) -> None:
        plan = self.gate.take(message)
        if plan is not None:
            self.plan = plan
            self._work()

    def _run_is_on(self) -> bool:
        last = self.core.tracker.last
        if self.plan is None or last is None:
            return False
        return self.plan.end == 0 or last < self.plan.end - 1

    def _on_voltage(self, message: VcaVoltage) -> None:
        self.pairing.add_voltage(message.sequence, message.voltage)
        self._work()

    def _on_acceleration(self, message: StrutAcceleration) -> None:
        arrival = self.pairing.add_sample(message.sequence, message)
        if arrival in {Arrival.FIRST, Arrival.RESTART}:
            check_period(
                f'{self.strut} acceleration', message.sample_period, self.parameters.sample_rate
            )
        self._work()

    def _work(self) -> None:
        """Process every sample that has all it needs."""
        if self.plan is not None or not self.parameters.lockstep:
            for sample, voltage, arrival in self.pairing.pairs():
                self._identify(sample, voltage, arrival)

    def _identify(self, sample: StrutAcceleration, voltage: float, arrival: Arrival) -> None:
        k, p = sample.sequence, self.parameters
        phase = Phase.STANDBY if self.plan is None else self.plan.at(k)
        found = self.core.step(
            k, phase, np.asarray(sample.upper), np.asarray(voltage), arrival,
            np.asarray(sample.upper_clipped),
        )  # fmt: skip
        handed = self.plan is not None and self.plan.is_hand_over(k + 1, p.model_period)
        if phase in self.phases or handed:
            self._publish(sample, found)

    def _publish(self, sample: StrutAcceleration, found: Identification) -> None:
        m = self.message
        m.header = sample.header
        m.sequence = sample.sequence
        fill(m, found.figures())
        self.publisher.publish(m)


def main() -> None:
    """Run the node."""
    run_node(StrutIdentifierNode)


if __name__ == '__main__':
    main()
