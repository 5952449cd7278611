# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A graph of one strut in real time, and all that it says.

One strut of the rig paper_1dof, 200 samples a second, velocity feedback. All spans are counted in samples.
"""

import time
from pathlib import Path

import numpy as np
from satvib_common.phases import Phase, PhasePlan
from satvib_common.struts.applied import Applied

HERE = Path(__file__).parent
CONTROLLER = ('satvib_control', 'strut_controller')
IDENTIFIER = ('satvib_ident', 'strut_identifier')
PLANT = ('satvib_plant_sim', 'plant_sim')
RECORDER = ('satvib_bringup', 'recorder')
RATE = 200
TIMEOUT = 0.6  # s; a machine that does other things may be away for half a second
LOOP = {'sample_rate': float(RATE), 'lockstep': False}
LAW = LOOP | {'law': 'velocity_feedback', 'struts': 1, 'state_period': 0.0}
PLAN = PhasePlan(
    (Phase.STANDBY, Phase.CALIBRATE, Phase.IDENTIFY, Phase.CONTROL), (0, 100, 300, 1500), 0
)
# where the model need not have settled
SOON = PhasePlan(PLAN.phases, (0, 100, 300, 700), 0)
# for a machine on which a process needs seconds to start
LONG = PhasePlan(PLAN.phases, (0, 100, 300, 100_000), 0)


def shake(plan):
    """A disturbance that begins with CONTROL; where that is far away, at 7.5 s."""
    begin = min(7.5, plan.first[-1] / RATE)
    return f'{{kind: sine, frequency: 10.0, amplitude: 1.0, start: {begin}}}'


class Timed(list):
    """Messages of samples, and when the first one of each sample was heard here, s of the steady clock."""

    def __init__(self):
        super().__init__()
        self.heard = {}

    def append(self, message):
        self.heard.setdefault(message.sequence, time.monotonic())
        super().append(message)


class OfOneRun(Timed):
    """Samples in their order; those of a second plant, which begins with 0 again, are left out."""

    def append(self, message):
        if not self or message.sequence > self[-1].sequence:
            super().append(message)


class Strut:
    """A graph of one strut in real time, and all that it says.

    Args:
        start, probe: as the fixtures.
        plan: its phases.
        between: with the fault node between plant and controller; the samples are then those that leave the plant.
        plant: parameters of the plant.
    """

    def __init__(self, start, probe, plan=PLAN, between=False, **plant):
        from diagnostic_msgs.msg import DiagnosticArray

        from satvib_msgs.msg import (
            ControllerState,
            IirParameters,
            Schedule,
            StrutAcceleration,
            VcaVoltage,
            VoltageApplied,
        )

        self.start, self.probe, self.plan = start, probe, plan
        setting = {'rig': 'paper_1dof', 'lockstep': False, 'disturbance': shake(plan)}
        self.setting = setting | {'command_timeout': TIMEOUT} | plant
        self.above = '/plant' if between else ''
        if between:
            self.between = start.script(HERE / 'fault_node.py', 'between')
        self.plant = start(
            *PLANT, more=self.aside('strut_1/acceleration', 'strut_1/voltage'), **self.setting
        )
        self.identifier = start(
            *IDENTIFIER, '/strut_1', more=self.aside('identified_model', strut='/strut_1'), **LOOP
        )
        # the test hears what it needs there and no more, for on two cores it would take a third of one
        self.law = LAW | {'state_period': 0.05} if between else LAW
        self.controller = start(*CONTROLLER, '/strut_1', **self.law)
        self.samples = probe.collect(
            StrutAcceleration,
            f'{self.above}/strut_1/acceleration',
            into=OfOneRun() if between else Timed(),
        )
        self.voltages = probe.collect(VcaVoltage, f'{self.above}/strut_1/voltage', into=Timed())
        self.states = probe.collect(ControllerState, '/strut_1/controller_state')
        if not between:
            self.models = probe.collect(IirParameters, '/strut_1/identified_model')
            self.blocks = probe.collect(VoltageApplied, '/strut_1/voltage_applied')
        self.reports = probe.collect(DiagnosticArray, '/diagnostics', whole=False)
        schedule = probe.publisher(Schedule, '/schedule')
        self.wait_for_readers()
        schedule.publish(
            Schedule(
                scenario='test', seed=1, sample_period=1.0 / RATE, struts=['strut_1'],
                phases=[int(p) for p in plan.phases], first_sequence=list(plan.first),
                end_sequence=plan.end,
            )
        )  # fmt: skip

    def aside(self, *topics, strut=''):
        """Arguments that move topics of a node to the other side of the fault node, where there is one."""
        words = (f'{t}:={self.above}{strut}/{t}' for t in topics if self.above)
        return tuple(word for pair in words for word in ('-r', pair))

    def wait_for_readers(self):
        """Until plant, controller and identifier have found each other."""
        node = self.probe.node
        self.probe.wait(
            lambda: (
                node.count_subscribers('/schedule') == 3
                and node.count_subscribers('/strut_1/acceleration') == (2 if self.above else 3)
                and node.count_subscribers('/strut_1/voltage') == (2 if self.above else 3)
                and node.count_publishers('/strut_1/voltage') == 1
                and (not self.above or self._is_between())
            )
        )

    def _is_between(self):
        node, sides = self.probe.node, ('/plant', '')
        topics = [f'{side}/strut_1/{t}' for side in sides for t in ('acceleration', 'voltage')]
        return all(node.count_publishers(t) == 1 and node.count_subscribers(t) > 0 for t in topics)

    @property
    def k(self):
        return self.samples[-1].sequence if self.samples else -1

    def away(self, first, last):
        """Whole samples by which the machine was behind the clock from one sample to another: the most of them.

        Between the time at which a sample is due and that at which it, or its voltage, is heard here lies what the
        plant, the strut and this test are late together. A sample is due as the most punctual one of all says.
        """
        heard = self.samples.heard
        zero = min(t - k / RATE for k, t in heard.items())
        late = [
            t - zero - k / RATE
            for times in (heard, self.voltages.heard)
            for k, t in times.items()
            if first <= k <= last
        ]
        return int(max(late, default=0.0) * RATE)

    def until(self, k):
        self.probe.wait(lambda: self.k >= k)

    def applied(self):
        """What the coil got: voltage and state by sample, as the samples say it."""
        voltage = {s.sequence - 1: s.applied for s in self.samples}
        state = {s.sequence - 1: Applied(s.applied_state) for s in self.samples}
        return voltage, state

    def state(self):
        """State of the newest sample."""
        return Applied(self.samples[-1].applied_state)

    def complaints(self, name):
        return {s.message for r in self.reports for s in r.status if s.name == name}

    def check_no_wrong_voltage(self):
        """While the strut was away or came back its coil had 0 V, or a share of a voltage that was asked for."""
        voltage, state = self.applied()
        asked = sorted((v.sequence, v.voltage) for v in self.voltages)
        numbers = np.array([k for k, _ in asked])
        fresh = TIMEOUT * RATE  # samples; an older voltage is none, as `command_timeout` says
        for k, s in state.items():
            if s in {Applied.SILENT, Applied.WAITING, Applied.LATCHED}:
                assert voltage[k] == 0.0
            elif s is Applied.RETURNING:
                recent = [
                    asked[i][1] for i in np.flatnonzero((numbers > k - fresh) & (numbers <= k))
                ]
                assert any(abs(voltage[k]) <= abs(v) + 1e-12 for v in recent)
