# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Compiles a kernel to a shared library. Only this module imports Numba, and only when a kernel is not on disk.

Numba makes the loop over the items of a generalized function and gives its code for LLVM, after optimization. From
that, LLVM emits an object that can stand anywhere in memory, and the machine's linker makes a library of it. Calls of
Numba's runtime go through pointers in the library, which `library.load` fills in.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from satvib_common.kernels.deferred import with_compiled_parts
from satvib_common.kernels.library import ABOUT, END, LOOP, SLOT, About, generalized, load, runtime

_DECLARED = re.compile(r'^declare (.*?)@"?([\w.]+)"?\((.*?)\).*$', re.MULTILINE)


def compile_kernel(
    function: Callable[..., None],
    signature: str,
    layout: str,
    writable: tuple[str, ...],
    path: Path | None,
) -> Any:
    """Compile a function for one item into a generalized function.

    Args:
        function: of one item.
        signature: Numba's types of the arguments.
        layout: core dimensions.
        writable: names of arguments that change in place.
        path: where the library is written; None where nothing can be written.

    Without a path or a linker the result lives in this process only.
    """
    with _without_coverage():
        from numba.core.compiler_lock import global_compiler_lock
        from numba.np.numpy_support import as_dtype
        from numba.np.ufunc.ufuncbuilder import GUFuncBuilder
        from numba.np.ufunc.wrappers import build_gufunc_wrapper
    builder = GUFuncBuilder(
        with_compiled_parts(function), layout, None, False, {'nopython': True}, writable
    )
    with global_compiler_lock:
        compiled = builder.add(signature)
        wrapper = build_gufunc_wrapper(
            builder.py_func, compiled, builder.sin, builder.sout, cache=False, is_parfors=False
        )
        # this also links and optimizes: the code is whole only afterwards
        address = wrapper.library.get_pointer_to_function(wrapper.name)
        text = wrapper.library.get_llvm_str()
    numbers = [int(as_dtype(getattr(t, 'dtype', t)).num) for t in compiled.signature.args]
    about = About(numbers, len(builder.sin), len(builder.sout), list(builder.writable_args), [])
    name, doc = function.__name__, function.__doc__
    if path is not None and _link(text, wrapper.name, about, path):
        return load(path, name, doc, layout)
    return generalized(address, about, name, doc, layout, (wrapper, compiled))


@contextmanager
def _without_coverage() -> Iterator[None]:
    """Let Numba find no `coverage`: it imports that tool for tests where it is installed, 0.2 s for nothing.

    Numba has no setting for it. A process that measures coverage has imported it before, and keeps it.
    """
    if 'coverage' in sys.modules:
        yield
        return
    sys.modules['coverage'] = None  # type: ignore[assignment] # Python's way to say: cannot be imported
    try:
        yield
    finally:
        del sys.modules['coverage']


def _link(text: str, loop: str, about: About, path: Path) -> bool:
    """Write the library; give whether there is a linker."""
    linker = shutil.which(os.environ.get('CC', '')) or shutil.which('cc') or shutil.which('c++')
    if linker is None:
        return False
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        thing, library = Path(folder, 'kernel.o'), Path(folder, path.name)
        thing.write_bytes(_emit(_with_symbols(text, loop, about)))
        done = subprocess.run(
            [linker, '-shared', '-s', '-o', str(library), str(thing), '-lm'],
            capture_output=True,
            check=False,
        )
        if done.returncode == 0:
            with library.open('ab') as sink:
                sink.write(END)
            library.replace(path)
        return done.returncode == 0


def _emit(text: str) -> bytes:
    """Emit an object that can stand anywhere, for the processor that Numba compiles for."""
    from llvmlite import binding
    from numba.core.registry import cpu_target

    codegen = cpu_target.target_context.codegen()
    machine = binding.Target.from_default_triple().create_target_machine(
        cpu=codegen._get_host_cpu_name(),  # noqa: SLF001
        features=codegen._get_host_cpu_features(),  # noqa: SLF001
        opt=3,
        reloc='pic',
        codemodel='default',
    )
    module = binding.parse_assembly(text)
    module.verify()
    thing: bytes = machine.emit_object(module)
    return thing


def _with_symbols(text: str, loop: str, about: About) -> str:
    """Add the public symbols of a library to the code of its loop."""
    slots = []

    def through_slot(found: re.Match[str]) -> str:
        before, name, arguments = found.groups()
        if name not in runtime():
            return found.group()
        about.needs.append(name)
        slots.append(f'@{SLOT}{name} = global ptr null\n')
        return _trampoline(before.strip(), name, arguments)

    text = _raising(_DECLARED.sub(through_slot, text))
    line = about.text()
    words = ''.join(f'\\{byte:02x}' for byte in line)
    return ''.join([
        text,
        '\n',
        *slots,
        f'@{ABOUT} = constant [{len(line) + 1} x i8] c"{words}\\00"\n',
        f'@{LOOP} = alias void (ptr, ptr, ptr, ptr), ptr @{loop}\n',
    ])  # fmt: skip


def _raising(text: str) -> str:
    """Let functions that raise read which exception it is.

    In its own process Numba gives `PyExc_ValueError` the address of the class. In a library it is what Python's headers
    say: a variable that holds that address.
    """
    added = []
    for name, more in (('PyErr_SetNone', ''), ('PyErr_SetString', ', ptr %text')):
        if f'@{name}(' in text:
            text = text.replace(f'@{name}(', f'@satvib_{name}(')
            text = re.sub(
                rf'^declare (.*)@satvib_{name}\(', rf'declare \1@{name}(', text, flags=re.MULTILINE
            )
            added.append(
                f'define internal void @satvib_{name}(ptr %variable{more}) {{\n'
                '  %class = load ptr, ptr %variable\n'
                f'  call void @{name}(ptr %class{more})\n  ret void\n}}\n'
            )
    return '\n'.join([text, *added])


def _trampoline(before: str, name: str, arguments: str) -> str:
    """Define a declared function: it calls what its slot points to."""
    kinds = [kind.strip() for kind in arguments.split(',') if kind.strip()]
    names = [f'{kind} %a{i}' for i, kind in enumerate(kinds)]
    result = before.split()[-1]
    give = 'ret void' if result == 'void' else f'ret {result} %r'
    call = f'call {result} %f({", ".join(names)})'
    return (
        f'define internal {before} @{name}({", ".join(names)}) {{\n'
        f'  %f = load ptr, ptr @{SLOT}{name}\n'
        f'  {call if result == "void" else "%r = " + call}\n'
        f'  {give}\n}}\n'
    )
