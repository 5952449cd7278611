# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `strut_identifier`: carries messages to and from `IdentifierCore`.

Sample k of the acceleration is paired by `sequence` with the voltage of sample k - delay, as the strut's guard let it
out. In lockstep both are waited for. In real time a voltage has until the next sample; after that it counts as not
known. Before sample 0 the voltage is known to be 0.

The model is published for every sample of a phase in which it is estimated, and for the samples before a hand-over.
"""

import math
import sys
from collections import deque

import numpy as np
from satvib_common.phases import Phase, PhasePlan
from satvib_common.ros.convert import check_period, doubles, plan_of
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.sequence import Arrival, SequenceTracker

from satvib_ident.identifier import Identification, IdentifierCore
from satvib_ident.parameters import IdentifierParameters
from satvib_msgs.msg import IirParameters, Schedule, StrutAcceleration, VcaVoltage


class StrutIdentifierNode(SatvibNode[IdentifierParameters]):
    """Identifies one strut."""

    def __init__(self) -> None:
        super().__init__('strut_identifier', IdentifierParameters)

    def make(self) -> None:
        """Build the core and the message that is refilled."""
        p = self.parameters
        self.core = IdentifierCore(p)
        self.plan: PhasePlan | None = None
        self.phases = frozenset(Phase[name] for name in p.estimate_in)
        self.waiting: deque[StrutAcceleration] = deque()
        self.voltages: dict[int, float] = {}
        self.samples, self.answers = SequenceTracker(), SequenceTracker()
        self.unpaired = 0
        self.message = IirParameters(sample_period=p.dt, delay=p.delay)
        self.publisher = self.publish_on(IirParameters, 'identified_model')

    def begin(self) -> None:
        """Listen to the strut and to the schedule."""
        qos = wanted(whole=self.parameters.lockstep)
        self.listen_to(Schedule, self.shared('schedule'), self._on_schedule, wanted(whole=True))
        self.listen_to(VcaVoltage, 'voltage', self._on_voltage, qos)
        self.listen_to(StrutAcceleration, 'acceleration', self._on_acceleration, qos)

    def reset(self) -> str:
        """Begin to estimate anew."""
        self.core.reset()
        return 'the estimate begins anew'

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give the counts of the core."""
        figures: dict[str, object] = {
            'sequence': -1 if self.samples.last is None else self.samples.last,
            'samples waiting': len(self.waiting),
            'samples without voltage': self.unpaired,
        }
        figures |= {name: int(np.max(value)) for name, value in self.core.counters.items()}
        lost = f'{self.samples.lost} samples lost' if self.samples.lost else ''
        return lost, figures

    def _on_schedule(self, message: Schedule) -> None:
        check_period('schedule', message.sample_period, self.parameters.sample_rate)
        self.plan = plan_of(message)
        self._work()

    def _on_voltage(self, message: VcaVoltage) -> None:
        if self.answers.see(message.sequence) is Arrival.RESTART:
            self.voltages.clear()
        self.voltages[message.sequence] = message.voltage
        self._work()

    def _on_acceleration(self, message: StrutAcceleration) -> None:
        k = message.sequence
        arrival = self.samples.see(k)
        if arrival in {Arrival.FIRST, Arrival.RESTART}:
            check_period(
                f'{self.strut} acceleration', message.sample_period, self.parameters.sample_rate
            )
            self.waiting.clear()
            if self.answers.last is not None and self.answers.last > k + 1:
                self.voltages.clear()  # of the run before
                self.answers = SequenceTracker()
        if arrival is not Arrival.REPEAT:
            self.waiting.append(message)
            self._work()

    def _work(self) -> None:
        """Take every sample whose voltage is there, or will never be."""
        lockstep = self.parameters.lockstep
        while self.waiting and (self.plan is not None or not lockstep):
            k = self.waiting[0].sequence
            wanted_voltage = k - self.parameters.delay
            voltage = 0.0 if wanted_voltage < 0 else self.voltages.get(wanted_voltage)
            if voltage is None:
                newest = self.answers.last
                passed = newest is not None and newest > wanted_voltage
                if not passed and (lockstep or len(self.waiting) < 2):
                    return
                voltage = math.nan
                self.unpaired += 1
            self._identify(self.waiting.popleft(), voltage)
            # what is older than this pair is of no use any more
            self.voltages.pop(wanted_voltage - 1, None)
            if len(self.voltages) > 2000:
                self.voltages = {s: v for s, v in self.voltages.items() if s >= wanted_voltage}

    def _identify(self, sample: StrutAcceleration, voltage: float) -> None:
        k, p = sample.sequence, self.parameters
        phase = Phase.STANDBY if self.plan is None else self.plan.at(k)
        found = self.core.step(k, phase, np.asarray(sample.upper), np.asarray(voltage))
        handed = self.plan is not None and self.plan.handoff(k + 1, p.model_period)
        if phase in self.phases or handed:
            self._publish(sample, found)

    def _publish(self, sample: StrutAcceleration, found: Identification) -> None:
        m = self.message
        m.header = sample.header
        m.sequence = sample.sequence
        m.a, m.b = doubles(found.a), doubles(found.b)
        m.standard_deviation = doubles(found.standard_deviation)
        m.covariance = doubles(found.covariance)
        m.prediction_error = float(found.prediction_error)
        m.noise_variance = float(found.noise_variance)
        m.bias = float(found.bias)
        m.updates = int(found.updates)
        m.excitation_order = int(found.excitation_order)
        m.information_eigenvalue = float(found.information_eigenvalue)
        m.information_condition = float(found.information_condition)
        m.whiteness = float(found.whiteness)
        m.pole_modulus = float(found.pole_modulus)
        m.converged = bool(found.converged)
        m.reason = found.reason
        self.publisher.publish(m)


def main() -> int:
    """Run the node."""
    return run_node(StrutIdentifierNode)


if __name__ == '__main__':
    sys.exit(main())
