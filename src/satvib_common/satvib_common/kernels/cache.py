# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where compiled kernels are kept, so that what is loaded always fits together and fits the source.

Numba keeps two files for a gufunc, the kernel and its wrapper, and the names inside them carry a counter of the process
that compiled. Files of two processes do not fit together, and calling the result is a crash. It also does not see when
a helper in another file has changed. Therefore every kernel has a folder of its own, named by a digest of all that its
machine code depends on; one process at a time fills it, from empty; and it counts only once it is complete.
"""

import contextlib
import fcntl
import hashlib
import inspect
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
from llvmlite import binding
from numba.core import config
from numba.core.dispatcher import Dispatcher

COMPLETE = 'complete'


def digest(function: Callable[..., Any], *settings: str) -> str:
    """Name everything that the machine code of a kernel depends on, in 16 hexadecimal digits."""
    total = hashlib.sha256()
    host = (binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten())
    for text in (numba.__version__, *host, *settings):
        total.update(text.encode() + b'\0')
    _add(total, function, set())
    return total.hexdigest()[:16]


def _add(total: Any, function: Callable[..., Any], seen: set[str]) -> None:
    """Add a function's file, its own source, and all compiled functions and constants that it names."""
    path = function.__code__.co_filename
    name = f'{path}:{function.__qualname__}'
    if name in seen:
        return
    seen.add(name)
    # Numba's own stamp is the whole file's content: a folder is good for one content
    total.update(Path(path).read_bytes())
    total.update(inspect.getsource(function).encode() + b'\0')
    for used in sorted(function.__code__.co_names):
        value = function.__globals__.get(used)
        if isinstance(value, ModuleType):
            # the other names of the function are looked up in it too: what is there may be a helper or a constant
            for member in sorted(function.__code__.co_names):
                _add_value(total, f'{used}.{member}', getattr(value, member, None), seen)
        else:
            _add_value(total, used, value, seen)


def _add_value(total: Any, name: str, value: Any, seen: set[str]) -> None:
    """Add what a name stands for, where machine code can depend on it."""
    if isinstance(value, Dispatcher):
        _add(total, value.py_func, seen)
    elif isinstance(value, type) and issubclass(value, Enum):
        total.update(f'{name}={[(m.name, m.value) for m in value]!r}'.encode() + b'\0')
    elif isinstance(value, type) and issubclass(value, tuple):
        total.update(f'{name}={getattr(value, "_fields", ())!r}'.encode() + b'\0')
    elif isinstance(value, bool | int | float | complex | str | tuple | Enum):
        total.update(f'{name}={value!r}'.encode() + b'\0')


@contextmanager
def own_folder(function: Callable[..., Any], *settings: str) -> Iterator[None]:
    """Let Numba's cache be the kernel's own complete folder, or an empty one that becomes complete at the end.

    Without a place to write, Numba's own rules hold (it then compiles at each start, or keeps nothing).
    """
    source = Path(function.__code__.co_filename).resolve()
    root = Path(config.CACHE_DIR) if config.CACHE_DIR else source.parent / '__pycache__'
    before = config.CACHE_DIR
    # the whole module, since files of two rooms may be named alike
    name = f'kernel-{function.__module__}-{function.__name__}'
    folder = root / f'{name}-{digest(function, *settings)}'
    try:
        root.mkdir(parents=True, exist_ok=True)
        lock = (root / f'{name}.lock').open('a')
    except OSError:
        yield
        return
    with lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        complete = folder / COMPLETE
        if not complete.exists():
            # what another version or a killed process has left is not used
            for stale in root.glob(f'{name}-{16 * "[0-9a-f]"}'):
                shutil.rmtree(stale, ignore_errors=True)
            folder.mkdir(parents=True, exist_ok=True)
        config.CACHE_DIR = str(folder)
        try:
            yield
        finally:
            config.CACHE_DIR = before
        with contextlib.suppress(OSError):
            complete.touch()
