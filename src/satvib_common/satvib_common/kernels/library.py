# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A kernel from its shared library, without Numba's compiler.

NumPy's generalized functions are made by a small extension module of Numba, and what machine code needs while it runs
(memory, errors) is in two others. They are loaded by their paths: `import numba` would load the compiler.
"""

import ctypes
import json
from functools import cache
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

# symbols of a library
ABOUT = 'satvib_about'
LOOP = 'satvib_loop'
SLOT = 'satvib_slot_'
# the last bytes of a whole file, behind the end of the library: to map a shorter one would kill the process
END = b'satvib: whole\n'


class About(NamedTuple):
    """What a library says of its kernel.

    Attributes:
        types: numbers of NumPy's types, of all arguments.
        inputs, outputs: how many arguments.
        writable: places of the arguments that change in place.
        needs: names of the functions of Numba's runtime that it calls.
    """

    types: list[int]
    inputs: int
    outputs: int
    writable: list[int]
    needs: list[str]

    def text(self) -> bytes:
        """Give it as one line, which a C string can hold."""
        return json.dumps(self._asdict()).encode()


def load(path: Path, name: str, doc: str | None, layout: str) -> Any:
    """Make the generalized function of a library.

    Args:
        path: of the library.
        name, doc: of the function, for people.
        layout: its core dimensions.

    Raises:
        OSError: the file is no such library.
    """
    if not path.read_bytes().endswith(END):
        raise OSError(f'{path}: not a whole file')
    library = ctypes.CDLL(str(path))
    try:
        # the string ends with a zero, which `string_at` looks for
        about = ctypes.string_at(ctypes.addressof(ctypes.c_char.in_dll(library, ABOUT)))
        loop = ctypes.cast(getattr(library, LOOP), ctypes.c_void_p).value
    except (ValueError, AttributeError) as error:
        raise OSError(f'{path}: {error}') from None
    says = About(**json.loads(about))
    for needed in says.needs:
        ctypes.c_void_p.in_dll(library, SLOT + needed).value = runtime()[needed]
    return generalized(loop, says, name, doc, layout, library)


def generalized(
    loop: int | None, about: About, name: str, doc: str | None, layout: str, owner: Any
) -> Any:
    """Make a generalized function from the address of its loop; `owner` lives as long as it."""
    internal = extension('numba.np.ufunc._internal')
    return internal.fromfunc(
        name, doc, [loop], [about.types], about.inputs, about.outputs, [None], owner,
        internal.PyUFunc_None, layout, tuple(about.writable),
    )  # fmt: skip


@cache
def runtime() -> dict[str, int]:
    """Give the addresses of Numba's runtime: what machine code calls it -> where it is."""
    memory = extension('numba.core.runtime._nrt_python').c_helpers
    addresses = {n if n.startswith('_') else f'NRT_{n}': a for n, a in memory.items()}
    helpers = extension('numba._helperlib').c_helpers
    return addresses | {f'numba_{name}': address for name, address in helpers.items()}


@cache
def extension(name: str) -> ModuleType:
    """Load an extension module of Numba by its path; the packages around it are not imported."""
    package, *folders, last = name.split('.')
    spec = find_spec(package)
    assert spec is not None
    assert spec.submodule_search_locations is not None
    folder = Path(spec.submodule_search_locations[0], *folders)
    found = (folder / (last + suffix) for suffix in EXTENSION_SUFFIXES)
    path = next(path for path in found if path.exists())
    own = spec_from_file_location(name, path)
    assert own is not None
    assert own.loader is not None
    module = module_from_spec(own)
    own.loader.exec_module(module)
    return module
