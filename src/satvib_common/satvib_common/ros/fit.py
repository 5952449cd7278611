# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a node does with a message that does not fit it: before a run it was started wrongly, in a run it is a stranger.

Before a run the error ends the node, so that a person corrects the parameters. In a run the message is refused: it is
logged as an error, and changes nothing.
"""

from collections.abc import Callable

from rclpy.node import Node

from satvib_common.errors import SatvibError
from satvib_common.ros.convert import check_period


class Fit:
    """The check of one node.

    Args:
        node: whose log is used.
        rate: Hz, sample rate of the node.
        running: whether a run is on now.
    """

    def __init__(self, node: Node, rate: float, running: Callable[[], bool]) -> None:
        self._node, self._rate, self._running = node, rate, running
        self._good: float | None = None

    def takes(self, what: str, period: float) -> bool:
        """Whether a message has the sample period (s) of the node; `what` begins the error.

        Raises:
            SatvibError: it has another one, and no run is on.
        """
        if period == self._good:
            return True
        try:
            check_period(what, period, self._rate)
        except SatvibError as error:
            self.refuse(error)
            return False
        self._good = period
        return True

    def refuse(self, error: SatvibError) -> None:
        """Leave a message out.

        Raises:
            SatvibError: the error, when no run is on.
        """
        if not self._running():
            raise error
        # a flood is one line for each second
        self._node.get_logger().error(f'refused: {error}', throttle_duration_sec=1.0)
