# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A mark of the modules that a cached kernel is compiled from.

Numba keeps compiled code as long as the kernel's own file stays the same, and does not look at the modules it calls.
A number that the kernel closes over is part of the key: with the checksum of those modules in it, a change there
compiles anew.
"""

import zlib
from pathlib import Path
from types import ModuleType


def stamp_of(*modules: ModuleType) -> int:
    """Give a number (at least 0) that changes with the text of the modules."""
    stamp = 0
    for module in modules:
        if module.__file__ is not None and Path(module.__file__).is_file():
            stamp = zlib.crc32(Path(module.__file__).read_bytes(), stamp)
    return stamp
