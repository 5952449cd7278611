# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `daq_bridge`: real hardware in the plant's place, with the plant's topics and messages.

    ros2 run satvib_daq_bridge daq_bridge --ros-args -p channels:=my_rig.yaml -p sample_rate:=200.0

It has no outputs of its own: a guardian process owns them (`guardian`). Configuring starts the guardian, which opens
the devices at 0 V, and the bias is learnt. The run begins with sample 0 when the schedule is there and ~/arm was
called. Services: ~/arm, ~/stop, ~/estop, ~/reset, ~/calibrate. Every change of state is on /diagnostics at once.
"""

import time
from functools import partial

from satvib_common.ros.loop.rivals import too_many_writers
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.ros.reporting import source_of
from satvib_common.ros.schedule_gate import ScheduleGate

from satvib_daq_bridge.bridge.bridge import Bridge, Published
from satvib_daq_bridge.bridge.session import Session
from satvib_daq_bridge.nodes.bridge_messages import BridgeOutputs
from satvib_daq_bridge.parameters import BridgeParameters
from satvib_daq_bridge.states import State, Transition
from satvib_msgs.msg import Schedule, VcaVoltage

_LATCHED = {State.FAULT, State.ESTOP}


class DaqBridgeNode(SatvibNode[BridgeParameters]):
    """Connects the graph to a session with the hardware."""

    def __init__(self) -> None:
        self.session: Session | None = None
        self.latched: Transition | None = None
        self.transitions: list[Transition] = []
        super().__init__('daq_bridge', BridgeParameters)

    @property
    def bridge(self) -> Bridge:
        """The bridge of the session."""
        assert self.session is not None
        return self.session.bridge

    def configure(self) -> None:
        """Open the devices at 0 V and begin to read."""
        p = self.parameters
        self.session = Session(p, lambda: self.wake(), self.transitions.append, self.latched)
        self.gate = ScheduleGate(
            self, 'schedule', p.sample_rate, lambda: self.bridge.running, self.bridge.struts
        )
        self.epoch = time.time_ns() - time.monotonic_ns()
        struts = self.bridge.struts
        self.out = BridgeOutputs(self.publish_on, struts, p.period, self.bridge.virtual)
        self.every(0.02, self._serve)
        self.every(0.1, self._look_for_others)
        for what in ('arm', 'estop', 'calibrate'):
            self.offer(what)

    def activate(self) -> None:
        """Listen to the controllers and to the schedule."""
        self.listen_to(Schedule, 'schedule', self._on_schedule, wanted(whole=True))
        for i, name in enumerate(self.bridge.struts):
            qos = wanted(whole=self.bridge.virtual)
            self.listen_to(VcaVoltage, f'{name}/voltage', partial(self._on_voltage, i), qos)

    def deactivate(self) -> None:
        """Leave the outputs at 0 V."""
        self.bridge.states.stop('deactivated')
        self._publish_transitions()

    def cleanup(self) -> None:
        """End the guardian, at 0 V; a latched fault is kept."""
        if self.session is not None:
            self.session.close('cleaned up')
            self.latched = self.bridge.states.latched
            self._publish_transitions()
        self.session = None

    def finish(self, line: str = '', code: int = 0) -> None:
        """Go to 0 V first, and then end; a signal handler calls this too."""
        if self.session is not None:
            self.bridge.states.stop('the process is told to end')
        super().finish(line, code)

    def arm(self) -> str:
        """IDLE -> ARMED, unless another node publishes voltages."""
        self.bridge.arm(self._others())
        return 'armed: voltages leave as soon as every strut has answered'

    def stop(self) -> str:
        """ARMED, ACTIVE -> IDLE."""
        self.bridge.states.stop('stopped by request')
        return f'0 V, {self.bridge.states.state.name}'

    def estop(self) -> str:
        """Latch 0 V."""
        self.bridge.states.estop('emergency stop by request')
        return '0 V, latched until reset'

    def reset(self) -> str:
        """FAULT, ESTOP -> IDLE."""
        assert self.session is not None
        self.session.reset()
        return 'IDLE; arm it again to go on'

    def calibrate(self) -> str:
        """Measure the bias again."""
        self.bridge.calibrate()
        return f'the rig must be at rest for {self.parameters.calibration_time:g} s'

    def tick(self) -> float:
        """Take what the guardian has sent; a thread wakes the loop for more."""
        self._serve()
        return 0.1

    def awaits(self) -> str:
        """Give what the run needs to begin, or the strut that has never answered."""
        what = self.bridge.awaited()
        return what.replace('schedule', f'schedule on {source_of(self, "schedule")}')

    def _on_schedule(self, message: Schedule) -> None:
        plan = self.gate.take(message)
        if plan is not None:
            self.bridge.schedule(plan.end)

    def _on_voltage(self, strut_index: int, message: VcaVoltage) -> None:
        self.bridge.command(strut_index, message.sequence, message.voltage)

    def _serve(self) -> None:
        assert self.session is not None
        for published in self.session.serve():
            if self.active:
                self._publish(published)
        if self.bridge.over and not self.ended:
            self.finish(self.bridge.over)
        while self.session.notes:
            self.get_logger().info(self.session.notes.pop(0))
        self._publish_transitions()

    def _publish(self, published: Published) -> None:
        stamp = round(published.time * 1e9) + self.epoch
        self.out.publish(published, stamp, self.bridge.states.reason)

    def _others(self) -> str:
        """Give a text about two publishers of voltages of one strut; empty without them."""
        return too_many_writers(self, *(f'{name}/voltage' for name in self.bridge.struts))

    def _look_for_others(self) -> None:
        if self.bridge.states.state in {State.ARMED, State.ACTIVE} and (others := self._others()):
            self.bridge.states.fault(others)

    def _publish_transitions(self) -> None:
        """Publish every change of state; those of a signal handler have waited for this."""
        while self.transitions:
            transition = self.transitions.pop(0)
            failed = transition.after in _LATCHED
            if failed:  # rclpy wants one place in the source for each severity
                self.get_logger().error(str(transition))
            else:
                self.get_logger().info(str(transition))
            after, before = transition.after.name, transition.before.name
            figures = {'state': after, 'before': before, 'reason': transition.reason}
            complaint = str(transition) if failed else ''
            self.reporting.diagnostics.publish(True, complaint, figures, str(transition), failed)

    def report_state(self) -> None:
        """Publish the state of the bridge on /diagnostics."""
        states, out = self.bridge.states, self.reporting.diagnostics
        awaited = self.reporting.awaited()
        complaint = states.reason if states.state in _LATCHED else ''
        well = f'{states.state.name}: {states.reason}{"; waits for " if awaited else ""}{awaited}'
        out.publish(True, complaint, self.bridge.diagnose(), well, bool(complaint))


def main() -> None:
    """Run the node."""
    run_node(DaqBridgeNode)


if __name__ == '__main__':
    main()
