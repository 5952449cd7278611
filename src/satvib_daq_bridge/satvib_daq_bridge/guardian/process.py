# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The guardian as a process: set-up from the bridge, signals, exit code. Run by `GuardianProcess`."""

import argparse
import os
import select
import signal
import socket
import sys
from types import FrameType
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.realtime import set_priority, set_processor

from satvib_daq_bridge.back_ends.base import BackEndError
from satvib_daq_bridge.back_ends.factory import make_back_end
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.guardian import link
from satvib_daq_bridge.guardian.guardian import Guardian
from satvib_daq_bridge.guardian.output_guard import OutputGuard


def set_up(given: dict[str, Any], bridge: link.Link) -> Guardian:
    """Build a guardian from the first message of the bridge.

    Raises:
        SatvibError: channels, options or devices that are not right.
    """
    channels = parse_channels(given['channels'], given['where'])
    period, max_age = 1.0 / given['sample_rate'], given['command_timeout']
    channels.check_rate(given['sample_rate'])
    back_end = make_back_end(channels, period, max_age)
    guard = OutputGuard(channels.outputs, period, max_age)
    return Guardian(back_end, guard, bridge)


def schedule(cpu: int, priority: int) -> list[str]:
    """Ask for a processor and SCHED_FIFO; gives what was not permitted."""
    refused: list[str] = []
    set_processor(cpu, refused.append)
    set_priority(priority, refused.append)
    return refused


def _serve(bridge: link.Link) -> int:
    """Read the set-up, then run the guardian until the end; gives the exit code."""
    end_seen, end_asked = os.pipe()

    def end(_: int, __: FrameType | None) -> None:
        os.write(end_asked, b'!')

    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, end)
    ready, _, _ = select.select([bridge.fileno(), end_seen], [], [], 10.0)
    message = b'' if end_seen in ready else bridge.receive()
    if not message:
        return 1
    guardian: Guardian | None = None
    try:
        given = link.read_text(message)
        guardian = set_up(given, bridge)
        found = guardian.back_end.open()
        refused = schedule(given['cpu'], given['priority'])
        if given.get('only_zero'):
            guardian.back_end.zero()
            return 0
        guardian.start()
        bridge.send(
            link.pack_text(
                link.ToBridge.READY,
                {'found': found, 'refused': refused, 'virtual': guardian.back_end.virtual},
            )
        )
        while not guardian.over:
            if guardian.step([end_seen]):
                break
    except (SatvibError, BackEndError) as error:
        bridge.send(link.pack_text(link.ToBridge.ERROR, str(error)))
        return 2
    finally:
        if guardian is not None:
            guardian.finish()
    return 0


def main(arguments: list[str] | None = None) -> int:
    """Run a guardian on the descriptor that its bridge gave it."""
    parser = argparse.ArgumentParser(prog='guardian', description=__doc__.splitlines()[0])
    parser.add_argument('descriptor', type=int, help='of the link to the bridge')
    given = parser.parse_args(arguments)
    return _serve(link.Link(socket.socket(fileno=given.descriptor)))


if __name__ == '__main__':
    sys.exit(main())
