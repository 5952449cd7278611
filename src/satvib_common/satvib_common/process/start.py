# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The first thing that an executable does: it takes SIGINT and SIGTERM, and only then imports what it runs.

A node imports for half a second, and compiles its kernels in the first minute of a workspace. Without handlers of its
own, Ctrl-C in that time is a KeyboardInterrupt somewhere in an import, with a traceback of the whole chain of imports.
Until there is something to put at rest, a signal ends the process at once.

A process that starts others blocks the two signals for them (`start_with_blocked_signals`). What comes before the
handlers are there is then kept by the kernel and arrives when they are. Started from a shell, the interpreter's own
start (30 to 60 ms) is not covered: there SIGTERM ends the process as it ends any other.

This module imports nothing that takes time.
"""

import signal
import sys
from collections.abc import Callable
from importlib import import_module
from os import _exit

SIGNALS = frozenset({signal.SIGINT, signal.SIGTERM})


def starter(
    module: str, function: str = 'main', code: int = 0, line: str = '', hand_back: bool = False
) -> Callable[[], int | None]:
    """Make the function of an entry point.

    Args:
        module, function: what runs.
        code: exit code when a signal comes before `function` has handlers of its own.
        line: what is then written to standard error.
        hand_back: give the signals back to Python after the imports, for a program that wants KeyboardInterrupt.
    """

    def start() -> int | None:
        def end(_number: int, _frame: object) -> None:
            if line:
                sys.stderr.write(f'{line}\n')
                sys.stderr.flush()
            _exit(code)

        for number in SIGNALS:
            signal.signal(number, end)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
        run: Callable[[], int | None] = getattr(import_module(module), function)
        if hand_back:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
            signal.signal(signal.SIGINT, signal.default_int_handler)
        return run()

    return start


def start_with_blocked_signals() -> None:
    """Block both signals for the program that this process becomes: a `preexec_fn`, or a call before `os.execv`.

    Only for programs that begin with `starter`, which unblocks them.
    """
    signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
