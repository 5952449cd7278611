# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Starts the guardian's process, notices its end, and puts the outputs to 0 V when it is gone."""

import contextlib
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from typing import Any

from satvib_common.errors import RunError, SatvibError

from satvib_daq_bridge.guardian import link

_START = 20.0  # s, for a Python process on a busy machine, and a device that takes its time
_END = 2.0  # s


class GuardianProcess:
    """A guardian that runs.

    Args:
        setup: what it needs: channels, where, sample_rate, command_timeout, cpu, priority.

    Raises:
        SatvibError: channels, options or devices that the guardian refused.
        RunError: it did not start.
    """

    def __init__(self, setup: Mapping[str, Any]) -> None:
        self._setup = dict(setup)
        self.popen, self.link = _start(self._setup)
        self.found: Mapping[str, Any] = self._wait_until_ready()

    @property
    def ended(self) -> bool:
        """Whether it ended without a request."""
        return self.link.closed

    def how(self) -> str:
        """How it ended, in words."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            code = self.popen.wait(0.2)
            return (
                f'was killed by {signal.Signals(-code).name}' if code < 0 else f'ended with {code}'
            )
        return 'closed its link'

    def stop(self) -> None:
        """Let it go to 0 V and end. When it ended with an error, another guardian puts the outputs to 0 V."""
        self.link.send(link.pack(link.ToGuardian.QUIT))
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.popen.wait(_END)
        if self.popen.returncode != 0:
            self.zero_outputs()
        self.link.close()

    def zero_outputs(self) -> None:
        """Make sure that this guardian is gone, and have another one put the outputs to 0 V and go."""
        with contextlib.suppress(ProcessLookupError):
            self.popen.kill()
        self.popen.wait()
        self.link.close()
        popen, end = _start({**self._setup, 'only_zero': True})
        try:
            popen.wait(_START)
        except subprocess.TimeoutExpired:
            popen.kill()
        end.close()

    def _wait_until_ready(self) -> Mapping[str, Any]:
        deadline = time.monotonic() + _START
        while time.monotonic() < deadline:
            select.select([self.link.fileno()], [], [], 0.1)
            message = self.link.receive()
            if message and message[0] == link.ToBridge.READY:
                ready: Mapping[str, Any] = link.read_text(message)
                return ready
            if message and message[0] == link.ToBridge.ERROR:
                self.popen.wait()
                raise SatvibError(link.read_text(message))
            if self.link.closed:
                raise RunError(f'the guardian {self.how()} before it was ready')
        self.popen.kill()
        raise RunError(f'the guardian is not ready after {_START:g} s')


def _start(setup: Mapping[str, Any]) -> tuple[subprocess.Popen[bytes], link.Link]:
    own, others = link.pair()
    environment = {
        **os.environ,
        'PYTHONPATH': os.pathsep.join(filter(None, sys.path)),
        'OPENBLAS_NUM_THREADS': '1',
        'OMP_NUM_THREADS': '1',
    }
    popen = subprocess.Popen(
        [sys.executable, '-m', 'satvib_daq_bridge.guardian.process', str(others.fileno())],
        pass_fds=[others.fileno()],
        stdin=subprocess.DEVNULL,
        # a session of its own: Ctrl-C at the terminal goes to the bridge alone, which then ends the guardian
        start_new_session=True,
        env=environment,
    )
    others.close()
    end = link.Link(own)
    end.send(link.pack_text(link.ToGuardian.SETUP, dict(setup)))
    return popen, end
