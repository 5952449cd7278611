# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The batch decorator: one plain loop per item, broadcast over any leading axes.

A kernel is a generalized function of NumPy. Its body is written for one strut of one trial; calling it with arrays that
have leading axes runs the same machine code item by item. So the bits of a result cannot depend on the batch's shape,
which vectorised NumPy and BLAS do not promise. Fast-math stays off for the same reason.

Compiled code is kept on disk (`cache`). A process that finds it there loads no compiler.
"""

import inspect
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

from satvib_common.kernels.cache import own_file
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.library import load

Kernel = Callable[..., Any]

# compiled kernel -> the function of one item
_FUNCTIONS: dict[Kernel, Kernel] = {}


def kernel(
    signature: str, layout: str, writable: tuple[str, ...] = ()
) -> Callable[[Callable[..., None]], Kernel]:
    """Compile a function for one item into a generalized function.

    Args:
        signature: Numba's types of the arguments, as in 'void(f8[:], f8[:,:], f8[:])'.
        layout: the core dimensions, as in '(n),(n,n)->(n)'. Outputs come last.
        writable: names of arguments on the left that the kernel changes in place. They must be float64 arrays with
            all the leading axes of the call: a copy made on the way in would lose what is written.

    Returns:
        A decorator. The compiled kernel takes arrays with any broadcastable leading axes.
    """

    def decorate(function: Callable[..., None]) -> Kernel:
        # one path, however a build has linked to the source
        code = function.__code__
        function.__code__ = code.replace(co_filename=str(Path(code.co_filename).resolve()))
        compiled = _compiled(function, signature, layout, writable)
        _FUNCTIONS[compiled] = function
        return compiled

    return decorate


def body(compiled: Kernel) -> Kernel:
    """Give the function of a kernel for use inside another one, as in a loop over samples.

    Scalars are arguments as they are; an output of the layout '()' is an array of one element.
    """
    function = _FUNCTIONS[compiled]
    assert isinstance(function, FunctionType)
    marked: Kernel = njit(function)
    return marked


def _compiled(
    function: Callable[..., None], signature: str, layout: str, writable: tuple[str, ...]
) -> Kernel:
    with own_file(function, signature, layout, repr(writable)) as path:
        if path is not None and path.exists():
            try:
                loaded: Kernel = load(path, function.__name__, inspect.getdoc(function), layout)
            except OSError:
                path.unlink()  # half a file, as a full disk leaves it
            else:
                return loaded
        from satvib_common.kernels.build import compile_kernel

        made: Kernel = compile_kernel(function, signature, layout, writable, path)
        return made
