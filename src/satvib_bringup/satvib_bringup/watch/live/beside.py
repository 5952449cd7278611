# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The page of `satvib run --watch`: the command `satvib watch` as a process that ends with the run."""

import contextlib
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from satvib_common.errors import SatvibError

from satvib_bringup.live.supervisor import Supervisor
from satvib_bringup.live.workspace import graph_environment

_NAME = 'watch'
_START, _POLL = 30.0, 0.05  # s


@contextlib.contextmanager
def page_beside() -> Iterator[str]:
    """Serve the page while the block runs; gives its address.

    Raises:
        SatvibError: the page cannot be served.
    """
    with tempfile.TemporaryDirectory() as folder:
        logs = Path(folder)
        with Supervisor(logs, graph_environment()) as supervisor:
            supervisor.start(_NAME, [sys.executable, '-m', 'satvib_bringup.cli.main', 'watch'])
            yield _address(supervisor, logs / f'{_NAME}.log')


def _address(supervisor: Supervisor, log: Path) -> str:
    """Wait until the process has said where the page is."""
    deadline = time.monotonic() + _START
    while time.monotonic() < deadline:
        for line in log.read_text(encoding='utf-8').splitlines():
            if line.startswith('http://'):
                return line
        if ended := supervisor.ended():
            raise SatvibError(f'--watch: {ended[0]}')
        time.sleep(_POLL)
    raise SatvibError(f'--watch: no page after {_START:g} s')
