# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The batch decorator: one plain loop per item, broadcast over any leading axes.

A kernel is a Numba gufunc. Its body is written for one strut of one trial; calling it with arrays that have leading
axes runs the same machine code item by item. So the bits of a result cannot depend on the batch's shape, which
vectorised NumPy and BLAS do not promise. Fast-math stays off for the same reason.

Compiled code is cached beside the source, or in NUMBA_CACHE_DIR. Numba keeps two files for a gufunc, and the names
inside them carry a counter of the process that compiled: files of two processes do not fit together, and calling the
result is a crash. So that processes that start together on a cold cache do not mix theirs, one at a time compiles.
"""

import fcntl
import hashlib
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numba import guvectorize

Kernel = Callable[..., Any]


@contextmanager
def _alone(source: str) -> Iterator[None]:
    """Hold the lock of a source file; without a place for locks, go on without one."""
    # a workspace built with links imports one file by several paths, and its cache is one
    name = hashlib.sha256(os.path.realpath(source).encode()).hexdigest()[:16]
    path = Path(tempfile.gettempdir()) / f'satvib-kernel-{os.getuid()}-{name}.lock'
    try:
        handle = path.open('a')
    except OSError:
        yield
        return
    with handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield


def kernel(
    signature: str, layout: str, writable: tuple[str, ...] = ()
) -> Callable[[Callable[..., None]], Kernel]:
    """Compile a function for one item into a gufunc.

    Args:
        signature: Numba's types of the arguments, as in 'void(f8[:], f8[:,:], f8[:])'.
        layout: the gufunc's core dimensions, as in '(n),(n,n)->(n)'. Outputs come last.
        writable: names of arguments on the left that the kernel changes in place. They must be float64 arrays with
            all the leading axes of the call: a copy made on the way in would lose what is written.

    Returns:
        A decorator. The compiled kernel takes arrays with any broadcastable leading axes.
    """

    def decorate(function: Callable[..., None]) -> Kernel:
        with _alone(function.__code__.co_filename):
            compiled: Kernel = guvectorize(
                [signature], layout, nopython=True, cache=True, writable_args=writable
            )(function)
        return compiled

    return decorate
