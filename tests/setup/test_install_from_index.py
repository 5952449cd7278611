# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Locks with extras are installed for real, when newer releases are out, by every installer that people have.

Truth: the versions in the lock. The index lies on disk; pip itself comes from the index that the machine has.
"""

import os
import subprocess
import sys
from importlib.metadata import distributions

import pytest
from lock_files import ROOT, entries, read
from packaging.utils import canonicalize_name
from small_index import small_index

PYTHON = f'{sys.version_info[0]}.{sys.version_info[1]}'
UV = ROOT / '.cache' / 'uv' / 'bin' / 'uv'
# Debian 12's; the last before pip took an extra's pin from its package; the newest
PIPS = [
    'pip==23.0.1',
    pytest.param('pip==23.2.1', marks=pytest.mark.long),
    pytest.param('pip==24.0', marks=pytest.mark.long),
    'pip',
]
OLD = 'pip==23.0.1' if sys.version_info < (3, 12) else 'pip==23.2.1'


@pytest.fixture
def index(tmp_path):
    folder = tmp_path / 'index'
    folder.mkdir()
    text, newer = small_index(folder, read(['ros.lock', 'satvib.lock']), PYTHON)
    assert {'coverage', 'ros-jazzy-rclpy', 'nidaqmx'} <= newer
    lock = tmp_path / 'small.lock'
    lock.write_text(text)
    return folder, lock


@pytest.fixture(scope='session')
def pip_wheel(tmp_path_factory):
    """Fetch a version of pip; skips when it cannot be had."""
    folder = tmp_path_factory.mktemp('pips')

    def fetch(wanted):
        if wanted == 'pip==23.0.1' and sys.version_info >= (3, 12):
            pytest.skip('pip 23.0.1 does not run on Python 3.12 and later')
        target = folder / wanted.replace('==', '-')
        command = [sys.executable, '-m', 'pip', 'download', '--quiet', '--no-deps', '--retries=1']
        env = os.environ | {'PIP_CONSTRAINT': os.devnull}
        done = subprocess.run(
            [*command, '-d', target, wanted], capture_output=True, text=True, env=env
        )
        if done.returncode:
            pytest.skip(f'{wanted} cannot be fetched: {done.stderr.strip().splitlines()[-1:]}')
        return next(target.glob('pip-*.whl'))

    return fetch


def clean():
    """An environment in which nothing but the arguments counts."""
    env = {k: v for k, v in os.environ.items() if not k.startswith(('PIP_', 'UV_'))}
    return env | {'PIP_CONFIG_FILE': os.devnull, 'UV_NO_CONFIG': '1'}


def with_pip(wheel, index, lock, target):
    command = [sys.executable, wheel / 'pip', 'install', '--no-index', '--find-links', index]
    command += ['--require-hashes', '-r', lock, '--target', target, '--no-cache-dir']
    return subprocess.run(command, capture_output=True, text=True, env=clean())


def installed(target):
    return {canonicalize_name(d.metadata['Name']): d.version for d in distributions(path=[target])}


def pinned(lock):
    return {name: version for (name, _), version in entries(lock.read_text(), PYTHON).items()}


@pytest.mark.parametrize('wanted', PIPS)
def test_pip_installs_what_the_lock_says(wanted, index, pip_wheel, tmp_path):
    wheels, lock = index
    done = with_pip(pip_wheel(wanted), wheels, lock, tmp_path / 'target')
    assert done.returncode == 0, done.stderr
    assert installed(tmp_path / 'target') == pinned(lock)


def test_uv_installs_what_the_lock_says(index, tmp_path):
    if not UV.exists():
        pytest.skip('uv could not be had when this workspace was set up')
    wheels, lock = index
    command = [UV, 'pip', 'install', '--no-index', '--find-links', wheels, '--no-cache', '-r', lock]
    command += ['--require-hashes', '--python', sys.executable, '--target', tmp_path / 'target']
    done = subprocess.run(command, capture_output=True, text=True, env=clean())
    assert done.returncode == 0, done.stderr
    assert installed(tmp_path / 'target') == pinned(lock)


def test_without_the_extras_an_old_pip_takes_the_newest_and_fails(index, pip_wheel, tmp_path):
    """What these tests are for: the locks as they once were."""
    wheels, lock = index
    lock.write_text('\n'.join(line.split('[')[0] + '==' + line.split('==')[1] if '[' in line else line
                              for line in lock.read_text().splitlines()))  # fmt: skip
    done = with_pip(pip_wheel(OLD), wheels, lock, tmp_path / 'target')
    assert done.returncode != 0
    assert 'coverage[toml]' in done.stderr
