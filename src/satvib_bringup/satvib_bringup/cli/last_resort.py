# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""An error that nobody foresaw: one line for people, the details in a file, an exit code of its own.

With the environment variable SATVIB_TRACEBACK=1 there is no last resort: the error goes on, as tests want it.
"""

import os
import platform
import sys
import tempfile
import traceback
from pathlib import Path

from satvib_common.errors import printable

EXIT_CODE = 70  # EX_SOFTWARE of sysexits.h
SWITCH = 'SATVIB_TRACEBACK'


def is_switched_off() -> bool:
    """Whether errors that nobody foresaw go on as they are."""
    return os.environ.get(SWITCH, '') not in {'', '0'}


def last_resort(error: BaseException, arguments: list[str]) -> str:
    """Write the details of an error to a file, and give the line to print.

    Args:
        error: what escaped.
        arguments: of the command, which say what was being done.
    """
    what = printable(' '.join(['satvib', *arguments]), 200)
    kind = printable(f'{type(error).__name__}: {error}'.strip(': '), 200)
    if isinstance(error, MemoryError):
        kind = 'not enough memory'
    details = ''.join(traceback.format_exception(error))
    about = f'{what}\nPython {platform.python_version()}, {platform.platform()}\n\n{details}'
    try:
        handle, name = tempfile.mkstemp(prefix='satvib-error-', suffix='.log', dir=_folder())
        with os.fdopen(handle, 'w', encoding='utf-8', errors='backslashreplace') as sink:
            sink.write(about)
        where = f'details: {name}'
    except OSError as problem:
        where = f'the details could not be kept: {problem.strerror}'
    return (
        f'{what}: a defect of satvib ({kind}); {where}; please report it with that file and the '
        f'input, {SWITCH}=1 shows all of it'
    )


def _folder() -> Path:
    """The current folder where it can be written, the folder for temporary files elsewhere."""
    here = Path.cwd()
    return here if os.access(here, os.W_OK) else Path(tempfile.gettempdir())


def show(text: str) -> None:
    """Print one line on standard error."""
    print(f'satvib: {printable(text)}', file=sys.stderr)  # noqa: T201 - a message for the terminal
