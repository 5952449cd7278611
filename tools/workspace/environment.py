# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The virtual environment `.venv`, from the locks."""

import subprocess
import sys
import time
from pathlib import Path

from workspace import installer
from workspace.base import (
    INHERITED,
    PYTHON,
    ROOT,
    VENV,
    digest,
    is_current,
    remove,
    run,
    say,
    write_whole,
)
from workspace.machine import check_room

STAMP = VENV / 'satvib-requirements'
# there while packages are put in: a killed installation leaves a mixture that no installer can tell from a good one
UNFINISHED = VENV / 'satvib-unfinished'


def locks(own_ros: bool) -> list[Path]:
    """Name the locks that are installed."""
    names = ['overlay.lock'] if own_ros else ['ros.lock', 'satvib.lock']
    return [ROOT / 'requirements' / name for name in names]


def wanted(own_ros: bool) -> str:
    """Name all that the environment is made from: locks, this Python, this place."""
    files = [*locks(own_ros), ROOT / 'requirements' / 'build.lock']
    return digest(files, sys.version, sys.base_prefix, str(VENV), str(own_ros))


def make_environment(own_ros: bool) -> None:
    """Create .venv and install the locked requirements.

    Raises:
        SetupError: it cannot be made.
    """
    target = wanted(own_ros)
    if is_current(STAMP, target) and PYTHON.exists():
        return
    started = time.monotonic()
    check_room()
    kind = digest([], sys.version, sys.base_prefix, str(VENV), str(own_ros))
    made = VENV / 'satvib-environment'
    if not is_current(made, kind) or UNFINISHED.exists() or not works():
        say(f'making the virtual environment {VENV.name}')
        remove(VENV)
        arguments = ['--system-site-packages'] if own_ros else []
        # the Python below an environment: that of .venv itself has just been removed
        base = getattr(sys, '_base_executable', sys.executable)
        run([base, '-m', 'venv', *arguments, str(VENV)], 'virtual environment')
        write_whole(made, kind)
    say('installing the locked requirements')
    STAMP.unlink(missing_ok=True)
    UNFINISHED.touch()
    name = installer.install(locks(own_ros))
    UNFINISHED.unlink()
    write_whole(STAMP, target)
    say(f'requirements installed by {name} in {time.monotonic() - started:.0f} s')


def works() -> bool:
    """Whether the environment's Python starts, and is the one that runs this."""
    try:
        asked = subprocess.run(
            [str(PYTHON), '-c', 'import sys, pip; print(sys.version)'],
            capture_output=True,
            text=True,
            check=False,
            pass_fds=INHERITED,
        )
    except OSError:
        return False
    return asked.returncode == 0 and asked.stdout.strip() == sys.version
