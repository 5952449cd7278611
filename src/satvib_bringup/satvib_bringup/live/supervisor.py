# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Starts, watches and stops processes, and leaves no orphan.

Every child has a session of its own, so that Ctrl-C at the terminal reaches the runner alone, which then stops the
children in order. The kernel sends a child SIGTERM when the runner ends, however it ends (PR_SET_PDEATHSIG); a node
that gets it ends by itself, at 0 V and with its files closed.
"""

import contextlib
import ctypes
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from satvib_common.errors import SatvibError
from satvib_common.process.start import start_with_blocked_signals

_PR_SET_PDEATHSIG = 1
# signals that a process gets for no fault of its own
_FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
# lines that are no reason to end
_LOGGED = re.compile(r'\[(DEBUG|INFO|WARN)\]')
_LIBC = ctypes.CDLL(None, use_errno=True)


@dataclass(frozen=True)
class Exit:
    """How a process ended.

    Attributes:
        name: of the process.
        code: exit code, or minus the signal's number.
        last_line: why, as it said itself; empty when it did not say.
    """

    name: str
    code: int
    last_line: str

    @property
    def how(self) -> str:
        """In words."""
        if self.code < 0:
            with contextlib.suppress(ValueError):
                return f'was killed by {signal.Signals(-self.code).name}'
        return f'ended with exit code {self.code}'

    def __str__(self) -> str:
        """The whole of it in one line."""
        # a node begins its last line with its own name, which is said already
        short = self.name.rpartition('/')[2]
        said = self.last_line.removeprefix(f'{short}: ')
        return f'{self.name} {self.how}{": " + said if said else ""}'


@dataclass
class _Child:
    name: str
    popen: subprocess.Popen[bytes]
    log: Path
    sink: IO[bytes]
    reported: bool = False


class Supervisor:
    """A set of child processes.

    Args:
        logs: folder for one log file per process; it is made.
        environment: of the children; None: the caller's own.
        take_signals: the children begin with `starter`, so that signals can be kept for them until they take them.
    """

    def __init__(
        self,
        logs: Path,
        environment: Mapping[str, str] | None = None,
        take_signals: bool = False,
    ) -> None:
        self.logs = logs
        self.take_signals = take_signals
        self.environment = environment
        self._children: dict[str, _Child] = {}
        logs.mkdir(parents=True, exist_ok=True)

    def __enter__(self) -> 'Supervisor':
        """Nothing is running yet."""
        return self

    def __exit__(self, *_: object) -> None:
        """Nothing is left running."""
        self.stop(self._children, patience=1.0)
        for child in self._children.values():
            child.sink.close()

    def start(self, name: str, command: Sequence[str]) -> int:
        """Start a process; gives its id.

        Raises:
            SatvibError: it cannot be started.
        """
        log = self.logs / f'{name.replace("/", ".")}.log'
        sink = log.open('wb')
        try:
            popen = subprocess.Popen(
                list(command),
                stdin=subprocess.DEVNULL,
                stdout=sink,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env=None if self.environment is None else dict(self.environment),
                preexec_fn=_end_with(os.getpid(), self.take_signals),
            )
        except OSError as error:
            sink.close()
            raise SatvibError(
                f'{name}: cannot be started: {error}; is the workspace built?'
            ) from None
        self._children[name] = _Child(name, popen, log, sink)
        return popen.pid

    def is_running(self, name: str) -> bool:
        """Whether a process is running."""
        return self._children[name].popen.poll() is None

    def pids(self) -> dict[str, int]:
        """Ids of the processes that are running."""
        return {n: c.popen.pid for n, c in self._children.items() if c.popen.poll() is None}

    def ended(self) -> list[Exit]:
        """Processes that have ended since the last call, the ones that were killed first."""
        found = []
        for child in self._children.values():
            code = child.popen.poll()
            if code is not None and not child.reported:
                child.reported = True
                found.append(_exit_of(child))
        return sorted(found, key=lambda ending: ending.code)

    def kill(self, name: str) -> None:
        """Kill a process, as the scenario asks; it is reported by `ended` like any other."""
        _signal(self._children[name], signal.SIGKILL)

    def stop(self, names: Iterable[str], patience: float) -> list[Exit]:
        """Ask processes to end and wait; after `patience` s they are killed.

        Gives how those ended that were running; a kill shows as -9.
        """
        running = [c for n in names if (c := self._children[n]).popen.poll() is None]
        for child in running:
            _signal(child, signal.SIGTERM)
        deadline = time.monotonic() + patience
        for child in running:
            try:
                child.popen.wait(max(deadline - time.monotonic(), 0.0))
            except subprocess.TimeoutExpired:
                _signal(child, signal.SIGKILL)
                child.popen.wait()
        for child in running:
            child.reported = True
        return [_exit_of(child) for child in running]


def _signal(child: _Child, number: signal.Signals) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child.popen.pid, number)


def _end_with(parent: int, take_signals: bool) -> Callable[[], Any]:
    """Make what a child does before it becomes the program: ask for SIGTERM when its parent ends."""
    prctl, sigterm = _LIBC.prctl, int(signal.SIGTERM)

    def before() -> None:
        prctl(_PR_SET_PDEATHSIG, sigterm, 0, 0, 0)
        if os.getppid() != parent:  # the parent ended before the request
            os._exit(1)
        if take_signals:
            start_with_blocked_signals()

    return before


def _exit_of(child: _Child) -> Exit:
    code = int(child.popen.returncode)
    # who is killed from outside says nothing about it: its last line is about something else
    said = '' if -code in _FROM_OUTSIDE else last_line(child.log, _LOGGED)
    return Exit(child.name, code, said)


def last_line(log: Path, without: re.Pattern[str] | None = None) -> str:
    """Give the last line of a log that says anything, of those that do not begin as `without` says."""
    with contextlib.suppress(OSError):
        with log.open('rb') as source:
            source.seek(0, os.SEEK_END)
            source.seek(max(source.tell() - 4096, 0))
            lines = source.read().decode(errors='replace').splitlines()
        for line in reversed(lines):
            if line.strip() and not (without and without.match(line)):
                return line.strip()
    return ''
