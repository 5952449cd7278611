# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The batch decorator: one plain loop per item, broadcast over any leading axes.

A kernel is a Numba gufunc. Its body is written for one strut of one trial; calling it with arrays that have leading
axes runs the same machine code item by item. So the bits of a result cannot depend on the batch's shape, which
vectorised NumPy and BLAS do not promise. Fast-math stays off for the same reason.

Compiled code is cached beside the source, or in NUMBA_CACHE_DIR (see `kernel_cache`).
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba import guvectorize, njit

from satvib_common.kernels.cache import own_folder

Kernel = Callable[..., Any]


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
        # Numba keeps what it compiles by the path of the source: one path, however a build has linked to it
        code = function.__code__
        function.__code__ = code.replace(co_filename=str(Path(code.co_filename).resolve()))
        with own_folder(function, signature, layout, repr(writable)):
            compiled: Kernel = guvectorize(
                [signature], layout, nopython=True, cache=True, writable_args=writable
            )(function)
        return compiled

    return decorate


def body(compiled: Kernel) -> Kernel:
    """Give the function of a kernel for use inside another one, as in a loop over samples.

    Scalars are arguments as they are; an output of the layout '()' is an array of one element.
    """
    function: Kernel = njit(compiled.__wrapped__)  # type: ignore[attr-defined] # functools sets it
    return function
