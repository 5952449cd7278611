# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a node does with a message that does not fit it: before a run it was started wrongly, in a run it is a stranger.

Before a run the error ends the node, so that a person corrects the parameters. In a run the message is refused: it is
logged as an error, and changes nothing.

One message is not enough to end a node. A node that is started again in the middle of a run gets messages of the time
before, and one of them may be damaged. A source that does not fit says the same with every message, so the second
message in a row that is wrong in the same way ends the node.
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
        self._unfit: dict[str, str] = {}  # by topic: what was wrong with its newest message

    def takes(self, what: str, period: float, wrong: str = '') -> bool:
        """Whether a message fits.

        Args:
            what: which message; begins the error, and tells one topic from another.
            period: s, sample period, as the message says.
            wrong: what else is wrong with it; empty: nothing.

        Raises:
            SatvibError: it does not fit, the one before it was wrong in the same way, and no run is on.
        """
        if period == self._good and not wrong:
            if self._unfit:
                self._unfit.pop(what, None)
            return True
        try:
            check_period(what, period, self._rate)
            if wrong:
                raise SatvibError(f'{what}: {wrong}')
        except SatvibError as error:
            self._refuse(what, error)
            return False
        self._good = period
        self._unfit.pop(what, None)
        return True

    def _refuse(self, what: str, error: SatvibError) -> None:
        again = self._unfit.get(what) == str(error)
        self._unfit[what] = str(error)
        if again and not self._running():
            raise error
        # a flood is one line for each second
        self._node.get_logger().error(f'refused: {error}', throttle_duration_sec=1.0)
