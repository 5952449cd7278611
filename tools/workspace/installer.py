# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Installs the locked requirements: with uv, and with pip where uv cannot be had.

uv comes through the environment's own pip, as one wheel with a locked hash, into `.cache/uv`. Source packages are built
with the locked setuptools, never with what the index offers on that day.
"""

import os
import subprocess
from pathlib import Path

from workspace import pip_settings
from workspace.base import (
    CACHE,
    INHERITED,
    PYTHON,
    ROOT,
    CommandError,
    digest,
    is_current,
    remove,
    run,
    say,
    without,
    write_whole,
)

REQUIREMENTS = ROOT / 'requirements'
UV_FOLDER = CACHE / 'uv'
UV = UV_FOLDER / 'bin' / 'uv'
# what would send pip's packages elsewhere; a constraint cannot add to a lock, only contradict it
PIP = [str(PYTHON), '-m', 'pip', '--disable-pip-version-check', '--no-input']
PLACES = ('PIP_TARGET', 'PIP_PREFIX', 'PIP_ROOT', 'PIP_REQUIRE_VIRTUALENV')


def install(locks: list[Path]) -> str:
    """Install locked requirements into the virtual environment.

    Returns:
        the name of the installer that did it.

    Raises:
        SetupError: neither uv nor pip could.
    """
    try:
        get_uv()
        with_uv([REQUIREMENTS / 'build.lock'])
        with_uv(locks)
    except CommandError as error:
        if error.cause:
            raise
        say('uv cannot be used here; installing with pip (a minute or two)')
    else:
        return 'uv'
    with_pip([REQUIREMENTS / 'build.lock'])
    with_pip(locks)
    return 'pip'


def pip_environment() -> dict[str, str]:
    """Give the environment in which pip installs into the virtual environment and nowhere else."""
    return without(*PLACES, PIP_USER='0', PIP_CONSTRAINT=os.devnull)


def get_uv() -> None:
    """Fetch the locked uv, unless it is there.

    Raises:
        CommandError: pip could not fetch it.
    """
    lock = REQUIREMENTS / 'uv.lock'
    stamp = UV_FOLDER / 'satvib-uv'
    wanted = digest([lock])
    if is_current(stamp, wanted) and os.access(UV, os.X_OK):
        return
    remove(UV_FOLDER)
    target = ['--target', str(UV_FOLDER), '--no-deps', '--only-binary', ':all:', '--retries', '2']
    run(
        [*PIP, 'install', *target, '--require-hashes', '-r', str(lock)],
        'fetching uv',
        pip_environment(),
    )
    write_whole(stamp, wanted)


def with_uv(locks: list[Path]) -> None:
    """Install with uv, from the indexes that pip is set up for.

    Every index counts the same, as with pip: which file is taken is decided by version and hash.

    Raises:
        CommandError: uv failed.
    """
    command = [str(UV), 'pip', 'install', '--python', str(PYTHON), '--no-progress']
    command += ['--index-strategy', 'unsafe-best-match', '--no-build-isolation', '--require-hashes']
    # the project's settings are none of uv's: neither a pyproject.toml nor another environment counts
    env = without('VIRTUAL_ENV', 'CONDA_PREFIX', 'PYTHONHOME', 'UV_CONSTRAINT', 'UV_OVERRIDE')
    listing = subprocess.run(
        [*PIP, 'config', 'list'],
        capture_output=True,
        text=True,
        check=False,
        pass_fds=INHERITED,
    ).stdout
    env |= pip_settings.for_uv(pip_settings.effective(listing), env)
    env |= pip_settings.uv_cache(env, CACHE / 'uv-cache')
    env.setdefault('UV_HTTP_RETRIES', '2')
    for lock in locks:
        command += ['-r', str(lock)]
    run(command, 'installing requirements', env)


def with_pip(locks: list[Path]) -> None:
    """Install with pip.

    Raises:
        CommandError: pip failed.
    """
    command = [*PIP, 'install', '--no-build-isolation', '--require-hashes']
    for lock in locks:
        command += ['-r', str(lock)]
    run(command, 'installing requirements', pip_environment())
