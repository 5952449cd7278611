# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Set up, build, demo and unit tests on every promised Python, each in a clone of its own; prints a table.

    python3 tools/every_python.py                 # 3.11, 3.12 and 3.13
    python3 tools/every_python.py 3.12 --no-tests # one of them, without the unit tests

Pythons are looked for on the path (python3.12), and below pyenv. What cannot be found is said, and counts as a failure.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VERSIONS = ('3.11', '3.12', '3.13')
# the unit tests, and what they say about the locks of this Python
UNIT = ('src', 'tests/setup/test_locks.py', 'tests/setup/test_install_from_index.py')
STEPS = ('install', 'build and kernels', 'demo', 'the other kernels', 'unit tests')
LOCK_LINE = re.compile(r'requirements installed by \w+ in (\d+) s')


def main() -> int:
    """Do it.

    Returns:
        0 when everything passed on every Python.
    """
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else '')
    parser.add_argument('versions', nargs='*', default=VERSIONS)
    parser.add_argument('--no-tests', action='store_true')
    given = parser.parse_args()
    rows = [(version, one(version, tests=not given.no_tests)) for version in given.versions]
    print('| Python | ' + ' | '.join(STEPS) + ' |')
    print('|---' * (len(STEPS) + 1) + '|')
    for version, cells in rows:
        print(f'| {version} | ' + ' | '.join(cells.get(step, '') for step in STEPS) + ' |')
    return int(any('FAILED' in ' '.join(cells.values()) for _, cells in rows))


def one(version: str, tests: bool) -> dict[str, str]:
    """Do everything with one Python; gives a cell of the table for each step."""
    python = find(version)
    if python is None:
        return {'install': f'FAILED: there is no Python {version} here'}
    cells: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as folder:
        clone = Path(folder) / 'satvib'
        subprocess.run(['git', 'clone', '--quiet', str(ROOT), str(clone)], check=True)
        if (ROOT.parent / 'shared').is_dir():  # measured records, where they are
            (Path(folder) / 'shared').symlink_to(ROOT.parent / 'shared')

        def step(name: str, *command: str) -> str | None:
            began = time.monotonic()
            done = subprocess.run(
                command,
                cwd=clone,
                env=os.environ | {'SATVIB_PYTHON': python},
                capture_output=True,
                text=True,
                check=False,
            )
            cells[name] = f'{time.monotonic() - began:.0f} s'
            print(f'{version}: {name}: {cells[name]}, exit code {done.returncode}', file=sys.stderr)
            if done.returncode:
                cells[name] = f'FAILED after {cells[name]}'
                print((done.stdout + done.stderr)[-4000:], file=sys.stderr)
                return None
            return done.stdout + done.stderr

        bootstrap = (python, '-IS', 'tools/bootstrap.py', 'demo')
        said = step('build and kernels', *bootstrap)
        if said is None:
            return cells
        if found := LOCK_LINE.search(said):
            cells['install'] = f'{found[1]} s'
            whole = int(cells['build and kernels'].split()[0])
            cells['build and kernels'] = f'{whole - int(found[1])} s'
        if step('demo', './satvib', 'demo') is None or not tests:
            return cells
        if step('the other kernels', python, '-IS', 'tools/bootstrap.py', 'test') is None:
            return cells
        said = step('unit tests', './satvib', 'test', *UNIT, '-q')
        if said and (found := re.search(r'\d+ passed.*', said)):
            cells['unit tests'] += f' ({found[0].split(" in ")[0]})'
    return cells


def find(version: str) -> str | None:
    """Find a Python of a version that starts."""
    pyenv = Path(os.environ.get('PYENV_ROOT', Path.home() / '.pyenv')) / 'versions'
    places = [str(path) for path in sorted(pyenv.glob(f'{version}.*/bin/python'))]
    places.append(shutil.which(f'python{version}') or '')
    code = f'import sys; sys.exit("%d.%d" % sys.version_info[:2] != "{version}")'
    for place in filter(None, places):
        if (
            subprocess.run([place, '-IS', '-c', code], capture_output=True, check=False).returncode
            == 0
        ):
            return place
    return None


if __name__ == '__main__':
    sys.exit(main())
