# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The colcon build of `src/`."""

import os
import shlex
import time
from pathlib import Path

from workspace import environment
from workspace.base import (
    CACHE,
    ENVIRONMENT,
    PYTHON,
    ROOT,
    VENV,
    CommandError,
    digest,
    is_current,
    remove,
    run,
    say,
    write_whole,
)
from workspace.prefix import OURS
from workspace.shell_environment import write_environment

# what a build depends on besides Python modules, which are linked in
FILES = ('package.xml', 'setup.py', 'setup.cfg', 'CMakeLists.txt')
SUFFIXES = ('.msg', '.srv', '.action', '.yaml', '.xml', '.launch.py')
TREES = ('build', 'install')
# there while colcon works: a killed build leaves files that are new and not whole, and make takes them for done
UNFINISHED = CACHE / 'build-unfinished'


def inputs() -> list[Path]:
    """Files that colcon turns into the install tree."""
    found = []
    for folder, below, names in os.walk(ROOT / 'src'):
        below[:] = [name for name in below if name != '__pycache__' and name[0] != '.']
        found += [
            Path(folder, name)
            for name in names
            if name in FILES or (name.endswith(SUFFIXES) and name[0] != '.')
        ]
    return found


def build(own_ros: bool) -> None:
    """Build the workspace when something that colcon installs has changed.

    Raises:
        SetupError: the build failed.
    """
    requirements = environment.STAMP.read_text()
    wanted = digest(inputs(), requirements, str(ROOT))
    stamp = CACHE / 'build'
    if is_current(stamp, wanted) and ENVIRONMENT.is_file() and (ROOT / 'install').is_dir():
        return
    started = time.monotonic()
    say('building the workspace')
    stamp.unlink(missing_ok=True)
    # trees of another place or another Python are of no use: CMake keeps absolute paths, and so do links
    ground = CACHE / 'build-ground'
    if UNFINISHED.exists() or not is_current(ground, requirements):
        for name in TREES:
            remove(ROOT / name)
        write_whole(ground, requirements)
    drop_loose_links()
    UNFINISHED.touch()
    try:
        run(['bash', '-c', colcon(own_ros)], 'colcon build', build_environment())
    except CommandError as error:
        if not error.cause:  # colcon came to its end, so what it left is whole
            UNFINISHED.unlink()
        raise
    UNFINISHED.unlink()
    write_environment(clean_environment())
    write_whole(stamp, wanted)
    say(f'workspace built in {time.monotonic() - started:.0f} s')


def drop_loose_links() -> None:
    """Remove links of an older build whose files are gone: setup.py would list them, and then not find them."""
    for name in TREES:
        for folder, below, files in os.walk(ROOT / name):
            for entry in (*below, *files):
                path = Path(folder, entry)
                if path.is_symlink() and not path.exists():
                    path.unlink()


def colcon(own_ros: bool) -> str:
    """Write the shell line that builds."""
    python = shlex.quote(str(PYTHON))
    # on an installed ROS 2 there are C++ nodes and other middlewares; with the wheels there are none
    only = '' if own_ros else ' -DSATVIB_PYTHON_ONLY=ON'
    underlay = '' if own_ros else f'. {shlex.quote(str(VENV / "setup.bash"))} && '
    return (
        f'{underlay}export PATH={shlex.quote(str(VENV / "bin"))}:"$PATH" && '
        f'exec {python} -m colcon build --symlink-install '
        f'--cmake-args -DBUILD_TESTING=OFF -DPython3_EXECUTABLE={python}{only}'
    )


def build_environment() -> dict[str, str]:
    """Give the environment that colcon builds in.

    make takes all cores however busy they are, and the generators of the messages keep their own modules compiled:
    each runs several times.
    """
    env = clean_environment()
    env.pop('PYTHONDONTWRITEBYTECODE', None)
    env.setdefault('MAKEFLAGS', f'-j{len(os.sched_getaffinity(0))}')
    return env


def clean_environment() -> dict[str, str]:
    """Give the caller's environment without an overlay of this very workspace."""
    drop = {'COLCON_PREFIX_PATH', 'COLCON_CURRENT_PREFIX', 'VIRTUAL_ENV', 'PYTHONHOME'}
    env = {k: v for k, v in os.environ.items() if k not in drop}
    for key in ('AMENT_PREFIX_PATH', 'CMAKE_PREFIX_PATH', 'PYTHONPATH', 'LD_LIBRARY_PATH', 'PATH'):
        # build, too: colcon puts the packages' sources on the path from there; and the prefix below the workspace
        own = (str(ROOT / 'install'), str(ROOT / 'build'), str(VENV))
        parts = [p for p in env.get(key, '').split(':') if p and not p.startswith(own)]
        env.pop(key, None)
        if parts:
            env[key] = ':'.join(parts)
    if OURS[0] in env:  # our own prefix, sourced by the caller: build afresh
        for key in OURS:
            env.pop(key, None)
    return env
