# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Files that appear whole or not at all: written beside their place, then moved there.

Whoever is killed in between leaves the old file as it was.
"""

import os
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from satvib_common.errors import SatvibError


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file; what was there is replaced.

    Args:
        path: of the file.
        write: is given the open file.

    Raises:
        SatvibError: it cannot be written; what was there is still there.
    """
    beside = path.with_name(f'{path.name}.new')
    try:
        with beside.open('wb') as sink:
            write(sink)
            sink.flush()
            os.fsync(sink.fileno())
        beside.replace(path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None
