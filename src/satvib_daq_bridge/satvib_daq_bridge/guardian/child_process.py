# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The bridge's end of the guardian: starts it, hears its end, and zeroes the outputs when it is gone."""

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

from satvib_daq_bridge.guardian import link as line

_START = 20.0  # s, for a Python process on a busy machine, and a device that takes its time
_END = 2.0  # s


class GuardianProcess:
    """A guardian that runs.

    Args:
        setup: what it needs: channels, where, sample_rate, command_timeout, cpu, priority.

    Raises:
        SatvibError: what the guardian refused: channels, options, devices.
        RunError: it did not start.
    """

    def __init__(self, setup: Mapping[str, Any]) -> None:
        self._setup = dict(setup)
        self.popen, self.line = _start(self._setup)
        self.found: Mapping[str, Any] = self._wait_until_ready()

    @property
    def died(self) -> bool:
        """Whether it is gone without having been told to go."""
        return self.line.closed

    def how(self) -> str:
        """How it went, in words."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            code = self.popen.wait(0.2)
            return (
                f'was killed by {signal.Signals(-code).name}' if code < 0 else f'ended with {code}'
            )
        return 'closed its line'

    def stop(self) -> None:
        """Let it go to 0 V and end; when it did not end well, another one zeroes the outputs."""
        self.line.send(bytes([line.QUIT]))
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.popen.wait(_END)
        if self.popen.returncode != 0:
            self.zero_outputs()
        self.line.close()

    def zero_outputs(self) -> None:
        """Make sure that this guardian is gone, and have another one put the outputs to 0 V and go."""
        with contextlib.suppress(ProcessLookupError):
            self.popen.kill()
        self.popen.wait()
        self.line.close()
        popen, end = _start({**self._setup, 'only_zero': True})
        try:
            popen.wait(_START)
        except subprocess.TimeoutExpired:
            popen.kill()
        end.close()

    def _wait_until_ready(self) -> Mapping[str, Any]:
        deadline = time.monotonic() + _START
        while time.monotonic() < deadline:
            select.select([self.line.fileno()], [], [], 0.1)
            message = self.line.receive()
            if message and message[0] == line.READY:
                ready: Mapping[str, Any] = line.read_text(message)
                return ready
            if message and message[0] == line.ERROR:
                self.popen.wait()
                raise SatvibError(line.read_text(message))
            if self.line.closed:
                raise RunError(f'the guardian {self.how()} before it was ready')
        self.popen.kill()
        raise RunError(f'the guardian is not ready after {_START:g} s')


def _start(setup: Mapping[str, Any]) -> tuple[subprocess.Popen[bytes], line.Line]:
    own, others = line.pair()
    environment = {
        **os.environ,
        'PYTHONPATH': os.pathsep.join(filter(None, sys.path)),
        'OPENBLAS_NUM_THREADS': '1',
        'OMP_NUM_THREADS': '1',
    }
    popen = subprocess.Popen(
        [sys.executable, '-m', 'satvib_daq_bridge.guardian.guardian', str(others.fileno())],
        pass_fds=[others.fileno()],
        stdin=subprocess.DEVNULL,
        # a session of its own: Ctrl-C at the terminal is for the bridge, which ends it in order
        start_new_session=True,
        env=environment,
    )
    others.close()
    end = line.Line(own)
    end.send(line.pack_text(line.SETUP, dict(setup)))
    return popen, end
