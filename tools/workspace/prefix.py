# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Makes the wheels' environment a ROS 2 prefix: CMake paths of this machine, and set-up files."""

import re
import shlex
import sys
import sysconfig
from pathlib import Path

from workspace import environment
from workspace.base import VENV, SetupError, digest, is_current, write_whole

# what the prefix of the wheels sets besides paths
OURS = (
    '_ROS_WHEELS_BOOTSTRAP_COMPLETE', 'ROS_DISTRO', 'ROS_VERSION', 'ROS_PYTHON_VERSION',
    'RMW_IMPLEMENTATION', 'ROS_AUTOMATIC_DISCOVERY_RANGE',
)  # fmt: skip

SETUP = """\
# Made by tools/workspace/prefix.py: makes this virtual environment a ROS 2 prefix.
_satvib_venv={venv}
_satvib_add() {{ eval "case \\":\\$$1:\\" in *\\":$2:\\"*) ;; *) export $1=\\"$2\\${{$1:+:\\$$1}}\\" ;; esac"; }}
_satvib_add AMENT_PREFIX_PATH "$_satvib_venv"
_satvib_add CMAKE_PREFIX_PATH "$_satvib_venv"
_satvib_add PATH "$_satvib_venv/bin"
for _satvib_dir in "$_satvib_venv/lib" "$_satvib_venv"/lib/python3*/site-packages/ros_*.libs; do
  [ -d "$_satvib_dir" ] && _satvib_add LD_LIBRARY_PATH "$_satvib_dir"
done
unset -f _satvib_add; unset _satvib_dir _satvib_venv
export ROS_DISTRO=jazzy ROS_VERSION=2 ROS_PYTHON_VERSION=3
export _ROS_WHEELS_BOOTSTRAP_COMPLETE=1
export RMW_IMPLEMENTATION="${{RMW_IMPLEMENTATION:-rmw_fastrtps_cpp}}"
export ROS_AUTOMATIC_DISCOVERY_RANGE="${{ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}}"
"""


def make_prefix(own_ros: bool) -> None:
    """Turn the wheels' environment into a ROS prefix.

    Raises:
        SetupError: a CMake file of the wheels cannot be repaired.
    """
    if own_ros:
        return
    wanted = digest([Path(__file__).resolve()], environment.STAMP.read_text())
    stamp = VENV / 'satvib-prefix'
    if is_current(stamp, wanted):
        return
    repair_cmake_paths()
    for name in ('local_setup.sh', 'local_setup.bash', 'setup.sh', 'setup.bash'):
        write_whole(VENV / name, SETUP.format(venv=shlex.quote(str(VENV))))
    write_whole(stamp, wanted)


def repair_cmake_paths() -> None:
    """Replace the paths of the machine that built the wheels by those of this one.

    Raises:
        SetupError: a foreign path is left.
    """
    version = f'{sys.version_info[0]}.{sys.version_info[1]}'
    tag = version.replace('.', '')
    foreign = f'/opt/python/cp{tag}-cp{tag}'
    site = VENV / 'lib' / f'python{version}' / 'site-packages'
    for path in (VENV / 'share').rglob('*.cmake'):
        before = path.read_text()
        after = (
            before.replace(f'{foreign}/include/python{version}', sysconfig.get_paths()['include'])
            .replace(f'{foreign}/lib/python{version}/site-packages', str(site))
            .replace(foreign, str(VENV))
        )
        if re.search(r'/opt/python/', after):
            raise SetupError(f'{path} still names the path of another machine')
        if after != before:
            # a new file in its place: the old one may be a hard link into an installer's cache
            write_whole(path, after)
