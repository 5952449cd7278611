# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Functions for the inside of kernels, which stay plain Python until a kernel has to be compiled.

`numba.njit` needs the compiler as soon as a module is imported: 0.8 s and 70 MB in every process. The `njit` of this
module takes the same options and only remembers them. Numba is imported when a kernel is compiled; a process that finds
its kernels on disk never imports it.
"""

from collections.abc import Callable
from types import CellType, FunctionType
from typing import Any

_MAKE = '__satvib_make__'
_MADE: dict[Any, Any] = {}


def njit(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """Mark a function for use inside kernels.

    Args:
        function: is given back as it is; called from Python it is slow.
        options: of `numba.njit`, such as `inline='always'`.
    """

    def mark(marked: Callable[..., Any]) -> Callable[..., Any]:
        def make() -> Any:
            import numba

            return numba.njit(**options)(with_compiled_parts(marked))

        setattr(marked, _MAKE, make)
        return marked

    return mark if function is None else mark(function)


def intrinsic(make: Callable[[], Any]) -> Any:
    """Mark a function without arguments that imports Numba and gives one of its intrinsics.

    Inside a kernel the name stands for that intrinsic.
    """
    setattr(make, _MAKE, make)
    return make


def is_deferred(value: Any) -> bool:
    """Whether a value is something that `njit` or `intrinsic` has marked."""
    return isinstance(value, FunctionType) and hasattr(value, _MAKE)


def for_compiler(value: Any) -> Any:
    """Give what Numba takes in the place of a value: itself, or what it is marked to become."""
    if not is_deferred(value):
        return value
    if value not in _MADE:
        _MADE[value] = getattr(value, _MAKE)()
    return _MADE[value]


def with_compiled_parts(function: Callable[..., Any]) -> Callable[..., Any]:
    """Copy a function so that every marked function that it names is what Numba takes for it."""
    assert isinstance(function, FunctionType)
    named = {name: function.__globals__.get(name) for name in function.__code__.co_names}
    parts = {name: for_compiler(value) for name, value in named.items() if is_deferred(value)}
    cells = tuple(CellType(for_compiler(cell.cell_contents)) for cell in function.__closure__ or ())
    copy = FunctionType(
        function.__code__,
        function.__globals__ | parts,
        function.__name__,
        function.__defaults__,
        cells or None,
    )
    copy.__kwdefaults__ = function.__kwdefaults__
    copy.__qualname__ = function.__qualname__
    copy.__doc__ = function.__doc__
    return copy
