# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where compiled kernels are kept, so that what is loaded always fits the source and the machine.

A kernel is one shared library, named by a digest of all that its machine code depends on: its own instructions, those
of the functions that it uses, the constants that it names, the compiler and the processor. Numba is not imported to
find it. One process at a time compiles a kernel; the file appears whole.
"""

import contextlib
import fcntl
import hashlib
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

# of the libraries: what is written before it is of no use after it
FORMAT = '1'

_PROCESSOR = ('vendor_id', 'cpu family', 'model', 'stepping', 'flags', 'CPU ', 'Features')


def digest(function: Callable[..., Any], *settings: str) -> str:
    """Name everything that the machine code of a kernel depends on, in 16 hexadecimal digits."""
    total = hashlib.sha256()
    for text in (FORMAT, sys.implementation.cache_tag or '', processor(), *settings):
        total.update(text.encode() + b'\0')
    for package in ('numba', 'llvmlite'):
        total.update(compiler_version(package))
    _add(total, function, set())
    return total.hexdigest()[:16]


@cache
def processor() -> str:
    """Name the processor and what it can do, as Linux does."""
    try:
        first = Path('/proc/cpuinfo').read_text(encoding='utf-8').partition('\n\n')[0]
    except OSError:
        return os.uname().machine
    return '\n'.join(line for line in first.splitlines() if line.startswith(_PROCESSOR))


@cache
def compiler_version(package: str) -> bytes:
    """Give the file that states the version of an installed package, which is not imported."""
    spec = find_spec(package)
    assert spec is not None
    return (Path(spec.submodule_search_locations[0]) / '_version.py').read_bytes()  # type: ignore[index]


def _add(total: Any, function: Callable[..., Any], seen: set[CodeType]) -> None:
    """Add what a function does, and all compiled functions and constants that it names."""
    code = function.__code__
    if code in seen:
        return
    seen.add(code)
    total.update(repr((function.__defaults__, function.__kwdefaults__)).encode() + b'\0')
    _add_code(total, code, function.__doc__)
    for name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True):
        _add_value(total, name, cell.cell_contents, seen)
    names = sorted(_names(code))
    for used in names:
        value = function.__globals__.get(used)
        if isinstance(value, ModuleType):
            # the other names of the function are looked up in it too: what is there may be a helper or a constant
            for member in names:
                _add_value(total, f'{used}.{member}', getattr(value, member, None), seen)
        else:
            _add_value(total, used, value, seen)


def _add_code(total: Any, code: CodeType, doc: str | None) -> None:
    """Add instructions and constants, without places in the file: a comment elsewhere changes no machine code."""
    total.update(code.co_code)
    total.update(repr((code.co_names, code.co_varnames, code.co_freevars)).encode() + b'\0')
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            _add_code(total, constant, None)
        elif isinstance(constant, frozenset):
            total.update(repr(sorted(map(repr, constant))).encode() + b'\0')
        elif doc is None or constant != doc:
            total.update(repr(constant).encode() + b'\0')


def _names(code: CodeType) -> set[str]:
    """Give the global names of a function and of the functions in it."""
    inner = (_names(c) for c in code.co_consts if isinstance(c, CodeType))
    return set(code.co_names).union(*inner)


def _add_value(total: Any, name: str, value: Any, seen: set[CodeType]) -> None:
    """Add what a name stands for, where machine code can depend on it."""
    if isinstance(value, FunctionType):
        _add(total, value, seen)
    elif isinstance(python := getattr(value, 'py_func', None), FunctionType):
        _add(total, python, seen)  # what `numba.njit` itself has made
    elif isinstance(value, type) and issubclass(value, Enum):
        total.update(f'{name}={[(m.name, m.value) for m in value]!r}'.encode() + b'\0')
    elif isinstance(value, type) and issubclass(value, tuple):
        total.update(f'{name}={getattr(value, "_fields", ())!r}'.encode() + b'\0')
    elif isinstance(value, bool | int | float | complex | str | tuple | Enum):
        total.update(f'{name}={value!r}'.encode() + b'\0')


@contextmanager
def own_file(function: Callable[..., Any], *settings: str) -> Iterator[Path | None]:
    """Give the file of a kernel; while it is missing, this process alone may make it.

    The file is beside the source, in NUMBA_CACHE_DIR when that is set, or in the user's cache when the folder of the
    source cannot be written; None when that cannot be written either. Files of other versions are deleted.
    """
    source = Path(function.__code__.co_filename)
    # the whole module, since files of two rooms may be named alike
    name = f'kernel-{function.__module__}-{function.__name__}'
    file = f'{name}-{digest(function, *settings)}.so'
    folders = _folders(source)
    for folder in folders:
        if (folder / file).exists():
            yield folder / file
            return
    for folder in folders:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            lock = (folder / f'{name}.lock').open('a')
        except OSError:
            continue
        with lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (folder / file).exists():
                for stale in folder.glob(f'{name}-{16 * "[0-9a-f]"}.so'):
                    with contextlib.suppress(OSError):
                        stale.unlink()
            yield folder / file
        return
    yield None


def _folders(source: Path) -> list[Path]:
    """Where the kernel of a source may be, first choice first."""
    if chosen := os.environ.get('NUMBA_CACHE_DIR'):
        return [Path(chosen)]
    home = Path(os.environ.get('XDG_CACHE_HOME') or Path.home() / '.cache')
    # two sources of the same name in the user's cache keep apart
    place = hashlib.sha256(str(source.parent).encode()).hexdigest()[:16]
    return [source.parent / '__pycache__', home / 'satvib' / place]
