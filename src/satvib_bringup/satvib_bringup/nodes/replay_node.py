# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `replay`: publishes a measured record as a strut's topics, so that a live strut_identifier identifies it.

    ros2 run satvib_bringup replay --ros-args -p file:=robot_arm.csv -p input:=torque -p output:=acceleration
    ros2 run satvib_ident strut_identifier --ros-args -r __ns:=/strut_1 -p lockstep:=true -p delay:=0 -p bias:=none

It begins when an identifier is there. At speed 0 it goes as fast as the identifier answers with models, or at 300
samples a second when the record has phases without models; otherwise at `speed` times the record's own rate.
"""

import time

from satvib_common.ros.convert import sample_stamp, set_stamp
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import offered, wanted

from satvib_bringup.live.schedule_message import schedule_message
from satvib_bringup.nodes.replay_record import ReplayParameters, load_record
from satvib_msgs.msg import IirParameters, Schedule, StrutAcceleration, VcaVoltage

_UNANSWERED_RATE = 300.0  # samples/s


class ReplayNode(SatvibNode[ReplayParameters]):
    """Plays a record."""

    def __init__(self) -> None:
        super().__init__('replay', ReplayParameters)

    def configure(self) -> None:
        """Read the record and offer the topics."""
        p = self.parameters
        self.record = load_record(p)
        for note in self.record.notes:
            self.get_logger().info(note)
        self.sample = StrutAcceleration(sample_period=self.record.period)
        self.sample.header.frame_id = p.strut
        self.voltage = VcaVoltage()
        self.schedule_out = self.publish_on(Schedule, 'schedule', offered(1))
        self.voltage_out = self.publish_on(VcaVoltage, f'{p.strut}/voltage')
        self.sample_out = self.publish_on(StrutAcceleration, f'{p.strut}/acceleration')
        self.k = 0
        self.followed = -1
        self.began: float | None = None

    def activate(self) -> None:
        """Watch how far the identifier is."""
        topic = f'{self.parameters.strut}/identified_model'
        self.listen_to(IirParameters, topic, self._on_model, wanted(whole=False))

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Say how far it is."""
        return '', {'sequence': self.k - 1, 'of': len(self.record.upper)}

    def awaits(self) -> str:
        """Say that no identifier is there."""
        hears = self.resolve_topic_name(f'{self.parameters.strut}/acceleration')
        return '' if self.began is not None else f'an identifier that hears {hears}'

    def tick(self) -> float:
        """Publish what is due."""
        if self.began is None:
            readers = (self.sample_out, self.voltage_out)
            if any(publisher.get_subscription_count() < 1 for publisher in readers):
                return 0.02
            self._announce()
        end = len(self.record.upper)
        while self.k < min(self._due(), end):
            self._publish(self.k)
            self.k += 1
        if self.k == end and not self._is_awaited():
            self.finish(f'{end} samples of {self.parameters.file} as {self.parameters.strut}')
        return 0.005

    def _is_awaited(self) -> bool:
        """Whether the identifier still works on the end of the record."""
        topic = f'{self.parameters.strut}/identified_model'
        behind = self.followed < len(self.record.upper) - 1
        return self.record.is_answered and behind and self.count_publishers(topic) > 0

    def _due(self) -> int:
        """How many samples may be out by now."""
        p, record = self.parameters, self.record
        if p.speed == 0.0 and record.is_answered:
            return self.followed + 1 + p.window
        rate = p.speed / record.period if p.speed > 0.0 else _UNANSWERED_RATE
        return int((time.monotonic() - (self.began or 0.0)) * rate) + 1

    def _announce(self) -> None:
        self.began = time.monotonic()
        record, now = self.record, self.get_clock().now().to_msg()
        name, source = self.parameters.strut, f'replay of {self.parameters.file}'
        message = schedule_message(record.plan, now, [name], record.period, source)
        self.schedule_out.publish(message)

    def _publish(self, k: int) -> None:
        record = self.record
        m, v = self.sample, self.voltage
        set_stamp(m.header.stamp, sample_stamp(k, record.period))
        m.sequence, m.upper, m.lower = k, float(record.upper[k]), float(record.lower[k])
        v.header, v.sequence, v.voltage = m.header, k, float(record.voltage[k])
        self.voltage_out.publish(v)
        self.sample_out.publish(m)

    def _on_model(self, message: IirParameters) -> None:
        self.followed = max(self.followed, message.sequence)
        self.wake()


def main() -> None:
    """Run the node."""
    run_node(ReplayNode)


if __name__ == '__main__':
    main()
