# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Compiled kernels on disk: never mixed, never stale. Truth: the arithmetic of the small kernels made here."""

import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

HELPER = """
from {compiler} import njit

@njit
def scaled(x):
    return {factor} * x
"""
KERNEL = """
from helper_of_kernel import scaled
from satvib_common.kernels.compile import kernel

OFFSET = {offset}

@kernel('void(f8[:], f8[:])', '(n)->(n)')
def affine(x, y):
    for i in range(x.shape[0]):
        y[i] = scaled(x[i]) + OFFSET
"""
CALL = 'import numpy as np, some_kernel; print(some_kernel.affine(np.ones(2)).tolist())'


@pytest.fixture
def folder(tmp_path):
    write(tmp_path)
    return tmp_path


def write(folder, factor=2.0, offset=1.0, compiler='satvib_common.kernels.deferred'):
    (folder / 'helper_of_kernel.py').write_text(HELPER.format(factor=factor, compiler=compiler))
    (folder / 'some_kernel.py').write_text(KERNEL.format(offset=offset))


def run(folder, code=CALL, **variables):
    """What a process says that finds its modules in a folder."""
    path = os.pathsep.join([str(folder), *sys.path])
    env = {k: v for k, v in os.environ.items() if k != 'NUMBA_CACHE_DIR'}
    # Python takes a module for the same when its size is the same and its second
    env['PYTHONDONTWRITEBYTECODE'] = '1'
    done = subprocess.run(
        [sys.executable, '-c', code], env=env | {'PYTHONPATH': path} | variables,
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


QUIET = (
    CALL
    + """
import sys
print(sorted({'numba', 'llvmlite', 'scipy', 'coverage', 'matplotlib'} & set(sys.modules)))
"""
)


@pytest.fixture(scope='module')
def cold(tmp_path_factory):
    """A folder with a compiled kernel, and what the processes said that started together when there was none."""
    folder = tmp_path_factory.mktemp('cold')
    write(folder)
    with ThreadPoolExecutor() as pool:
        together = [pool.submit(run, folder, QUIET) for _ in range(4)]
        return folder, [started.result() for started in together]


@pytest.fixture
def compiled(cold, folder):
    """A folder of its own with a compiled kernel: time stamps and all, as a copy of a repository has it."""
    shutil.rmtree(folder)
    shutil.copytree(cold[0], folder)
    return folder


def kept(folder):
    return sorted((folder / '__pycache__').glob('kernel-some_kernel-affine-*.so'))


def test_processes_that_start_together_on_a_cold_cache_all_compute(cold):
    folder, said = cold
    assert [text.splitlines()[0] for text in said] == ['[3.0, 3.0]'] * 4
    assert run(folder) == '[3.0, 3.0]'
    assert len(kept(folder)) == 1


@pytest.mark.parametrize(('change', 'expected'), [({'factor': 5.0}, 6.0), ({'offset': 7.0}, 9.0)])
def test_a_changed_helper_or_constant_compiles_anew(compiled, change, expected):
    before = kept(compiled)
    write(compiled, **change)
    assert run(compiled) == f'[{expected}, {expected}]'
    after = kept(compiled)
    assert len(after) == 1
    assert after != before


def test_what_a_full_disk_left_is_not_used(compiled):
    """A library that cannot be loaded is made again."""
    (only,) = kept(compiled)
    only.write_bytes(only.read_bytes()[:1000])
    assert run(compiled) == '[3.0, 3.0]'
    assert only.stat().st_size > 1000


def test_a_comment_compiles_nothing(compiled):
    """Truth: the name of the library, which is a digest of what it depends on, and its time."""
    (before,) = kept(compiled)
    written = before.stat().st_mtime_ns
    for name in ('helper_of_kernel.py', 'some_kernel.py'):
        path = compiled / name
        path.write_text('# a comment\n' + path.read_text())
    assert run(compiled) == '[3.0, 3.0]'
    assert [path.stat().st_mtime_ns for path in kept(compiled)] == [written]


def test_a_helper_made_by_numba_itself_is_followed(folder):
    """A law of a user may take `njit` from Numba."""
    write(folder, compiler='numba')
    assert run(folder) == '[3.0, 3.0]'
    write(folder, factor=5.0, compiler='numba')
    assert run(folder) == '[6.0, 6.0]'
    assert len(kept(folder)) == 1


def test_without_a_linker_a_process_compiles_for_itself(folder, tmp_path_factory):
    """Truth: the same arithmetic; nothing is kept."""
    nothing = str(tmp_path_factory.mktemp('no_programs'))
    assert run(folder, CALL, PATH=nothing) == '[3.0, 3.0]'
    assert kept(folder) == []


def test_a_folder_that_cannot_be_written_keeps_kernels_in_the_cache_of_the_user(folder, tmp_path):
    """A package that root has installed; here a file is where the folder would be."""
    (folder / '__pycache__').write_text('no folder')
    home = tmp_path / 'cache'
    for _ in range(2):
        assert run(folder, CALL, XDG_CACHE_HOME=str(home)) == '[3.0, 3.0]'
    (only,) = home.glob('satvib/*/kernel-some_kernel-affine-*.so')
    assert only.stat().st_size > 0


def test_a_kernel_on_disk_needs_no_compiler(cold, compiled):
    """Truth: the modules of a process that finds its kernel, and of those that have made it."""
    _, said = cold
    assert any("'numba'" in text for text in said)
    assert run(compiled, QUIET) == '[3.0, 3.0]\n[]'


FAILING = """
import numpy as np
from satvib_common.kernels.compile import kernel

@kernel('void(f8[:], f8[:])', '(n)->(n)')
def root(x, y):
    if x[0] < 0.0:
        raise ValueError('negative')
    y[:] = np.zeros(2)[: x.shape[0]]
"""
RAISE = """
import numpy as np
import some_kernel
for x in (-np.ones(2), np.ones(3)):
    try:
        some_kernel.root(x)
    except (ValueError, RuntimeError) as error:
        print(type(error).__name__, error)
"""


def test_an_error_of_machine_code_is_an_error_of_python(tmp_path):
    """Truth: Python. Where Numba's words have numbers in them (here the shapes that do not fit), they are lost."""
    (tmp_path / 'some_kernel.py').write_text(FAILING)
    for _ in range(2):
        first, second = run(tmp_path, RAISE).splitlines()
        assert first == 'ValueError negative'
        assert second.startswith('RuntimeError')


def test_a_linked_path_loads_what_the_source_compiled(compiled, tmp_path_factory):
    """A colcon build links to the sources; both paths share one compiled kernel."""
    (before,) = kept(compiled)
    written = before.stat().st_mtime_ns
    linked = tmp_path_factory.mktemp('build') / 'linked'
    linked.symlink_to(compiled)
    assert run(linked) == '[3.0, 3.0]'
    assert [path.stat().st_mtime_ns for path in kept(compiled)] == [written]


PLACE = 'from enum import IntEnum\nclass Place(IntEnum):\n    SECOND = {}\n'
PICK = """
import numbers_of_kernel
from satvib_common.kernels.compile import kernel

@kernel('void(f8[:], f8[:])', '(n)->()')
def pick(x, y):
    y[0] = x[Place.SECOND] * numbers_of_kernel.FACTOR
"""
PICK_BOTH = """
import numpy as np, own_place, other_place
print(own_place.pick(np.arange(3.0)), other_place.pick(np.arange(3.0)))
"""


def test_a_changed_constant_behind_a_module_or_an_enum_compiles_again(tmp_path):
    """The file of `other_place` keeps its text when an enum or a constant of another module changes."""
    (tmp_path / 'other_place.py').write_text('from places_of_kernel import Place\n' + PICK)
    for own, other, factor in [(1, 0, 10.0), (1, 0, 30.0), (2, 2, 30.0)]:
        (tmp_path / 'numbers_of_kernel.py').write_text(f'FACTOR = {factor}')
        (tmp_path / 'places_of_kernel.py').write_text(PLACE.format(other))
        (tmp_path / 'own_place.py').write_text(PLACE.format(own) + PICK)
        assert run(tmp_path, PICK_BOTH) == f'{own * factor} {other * factor}'


def test_modules_and_kernels_of_the_same_name_keep_both(tmp_path):
    """Two rooms with a `watch.py` and a kernel `look` each, in one NUMBA_CACHE_DIR: neither deletes the other's."""
    source = KERNEL.replace('affine', 'look').replace('scaled(x[i])', 'x[i]')
    source = source.replace('from helper_of_kernel import scaled\n', '')
    for room, offset in [('one', 1.0), ('two', 2.0)]:
        (tmp_path / room).mkdir()
        (tmp_path / room / '__init__.py').touch()
        (tmp_path / room / 'watch.py').write_text(source.format(offset=offset))
    cache = tmp_path / 'cache'
    code = 'import numpy as np; from {} import watch; print(watch.look(np.zeros(1)).tolist())'
    found = []
    for _ in range(2):
        for room, expected in [('one', '[1.0]'), ('two', '[2.0]')]:
            assert run(tmp_path, code.format(room), NUMBA_CACHE_DIR=str(cache)) == expected
        found.append({p: p.stat().st_mtime_ns for p in cache.rglob('*.so')})
    assert len(found[0]) == 2
    assert found[0].keys() == found[1].keys()
