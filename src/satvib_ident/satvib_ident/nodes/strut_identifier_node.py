# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `strut_identifier`: carries messages to and from `IdentifierCore`.

Sample k of the acceleration is paired with the voltage of sample k - delay that the strut's guard applied (see
`voltage_pairing`). In lockstep the node waits for both and for the schedule.

When the model is published is in `model_times`. After the last sample that it estimates with, the node hears nothing
more: it ends its subscriptions and costs nothing, until a new schedule or another source of samples is there.
"""

import numpy as np
from satvib_common.phases import Phase
from satvib_common.ros.convert import check_period, fill, set_header
from satvib_common.ros.delivery.endpoints import Input
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.ros.schedule_gate import ScheduleGate
from satvib_common.sequence import Arrival, SequenceTracker

from satvib_ident.identifier import Identification, IdentifierCore
from satvib_ident.model_times import ModelTimes
from satvib_ident.nodes.voltage_pairing import VoltagePairing
from satvib_ident.parameters import IdentifierParameters
from satvib_ident.rehearsal import rehearse
from satvib_msgs.msg import IirParameters, Schedule, StrutAcceleration, VcaVoltage

_GATHER = 0.005  # s
_NEAR = 9  # samples
_LOOK = 0.1  # s


class StrutIdentifierNode(SatvibNode[IdentifierParameters]):
    """Identifies one strut."""

    rank = 1

    def __init__(self) -> None:
        super().__init__('strut_identifier', IdentifierParameters)

    def configure(self) -> None:
        """Build the core and the message that is refilled."""
        p = self.parameters
        if not p.lockstep:
            rehearse(IdentifierCore(p))
        self.core = IdentifierCore(p)
        self.times: ModelTimes | None = None
        self.gate = ScheduleGate(self, self.shared('schedule'), p.sample_rate, self._run_is_on)
        self.ears: list[Input] = []
        self.sources: set[bytes] = set()  # of the samples, when the node ceased to listen
        self.phases = frozenset(Phase[name] for name in p.estimate_in)
        self.core.tracker = SequenceTracker(confirm=True, zero_restarts=p.lockstep)
        self.pairing: VoltagePairing[StrutAcceleration] = VoltagePairing(
            p.delay, p.lockstep, self.core.tracker
        )
        self.message = IirParameters(sample_period=p.dt, delay=p.delay)
        self.publisher = self.publish_on(IirParameters, 'identified_model')

    def activate(self) -> None:
        """Listen to the strut and to the schedule."""
        self.listen_to(Schedule, self.shared('schedule'), self._on_schedule, wanted(whole=True))
        self._listen()

    def deactivate(self) -> None:
        """The base ends the subscriptions."""
        self.ears.clear()

    def tick(self) -> float:
        """While the node hears nothing, look now and then whether there is another source of samples."""
        if self.ears:
            return super().tick()
        present = self._present_sources()
        if present and not present & self.sources:
            self._listen()
        return _LOOK

    def _listen(self) -> None:
        qos = wanted(whole=self.parameters.lockstep)
        self.ears = [
            self.listen_to(VcaVoltage, 'voltage', self._on_voltage, qos),
            self.listen_to(StrutAcceleration, 'acceleration', self._on_acceleration, qos),
        ]

    def _cease_to_listen(self) -> None:
        self.sources = self._present_sources()
        for ear in self.ears:
            self.forget(ear)
        self.ears.clear()

    def _present_sources(self) -> set[bytes]:
        infos = self.get_publishers_info_by_topic(self.resolve_topic_name('acceleration'))
        return {bytes(info.endpoint_gid) for info in infos}

    def pause(self) -> float:
        """In lockstep messages gather until a hand-over is near, which saves wake-ups."""
        times, last = self.times, self.core.tracker.last
        if not self.ears or times is None or last is None or not self.parameters.lockstep:
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
        if plan is None:
            return
        self.times = ModelTimes(plan, self.phases, self.parameters.model_period)
        if not self.ears:
            self._listen()
        self._work()

    def _run_is_on(self) -> bool:
        last = self.core.tracker.last
        if self.times is None or last is None:
            return False
        if not self.ears:  # the run goes on without this node
            return bool(self._present_sources() & self.sources)
        end = self.times.plan.end
        return end == 0 or last < end - 1

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
        if self.times is not None or not self.parameters.lockstep:
            for sample, voltage, arrival in self.pairing.pairs():
                self._identify(sample, voltage, arrival)

    def _identify(self, sample: StrutAcceleration, voltage: float, arrival: Arrival) -> None:
        k, times = sample.sequence, self.times
        phase = Phase.STANDBY if times is None else times.plan.at(k)
        found = self.core.step(
            k, phase, np.asarray(sample.upper), np.asarray(voltage), arrival,
            np.asarray(sample.upper_clipped),
        )  # fmt: skip
        if times is None:
            return
        if times.publishes(k):
            self._publish(sample, found, times.next_after(k))
        if self.ears and times.is_over(k):
            self._cease_to_listen()

    def _publish(self, sample: StrutAcceleration, found: Identification, after: int) -> None:
        m = self.message
        set_header(m, sample.header)
        m.sequence = sample.sequence
        fill(m, found.figures())
        m.next_sequence = after
        self.publisher.publish(m)


def main() -> None:
    """Run the node."""
    run_node(StrutIdentifierNode)


if __name__ == '__main__':
    main()
