# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the machine must have before anything is made."""

import importlib.util
import os
import shutil
import sys
import sysconfig
from pathlib import Path

from workspace.base import ROOT, SetupError

SUPPORTED = ((3, 11), (3, 13))
NEEDED = 2_000_000_000  # bytes: virtual environment, build, kernels, the installer's cache


def sourced_ros() -> bool:
    """Whether the caller has sourced a ROS 2 installation of its own.

    Raises:
        SetupError: one is sourced, but not Jazzy.
    """
    if os.environ.get('_ROS_WHEELS_BOOTSTRAP_COMPLETE') or 'ROS_DISTRO' not in os.environ:
        return False
    distro = os.environ['ROS_DISTRO']
    if distro != 'jazzy':
        raise SetupError(
            f'ROS 2 {distro} is sourced, jazzy is needed; open a shell without it, and satvib '
            'brings its own'
        )
    return True


def check_machine(own_ros: bool) -> None:
    """Say in one line what is missing.

    Raises:
        SetupError: naming the missing part and what to install.
    """
    low, high = SUPPORTED
    if not low <= sys.version_info[:2] <= high:
        raise SetupError(
            f'Python {sys.version_info[0]}.{sys.version_info[1]} is too old or too new: '
            f'{low[0]}.{low[1]} to {high[0]}.{high[1]} is needed; name one in SATVIB_PYTHON'
        )
    if (sys.platform != 'linux' or os.uname().machine != 'x86_64') and not own_ros:
        raise SetupError(
            'the ROS 2 wheels exist for Linux on x86-64 only; source a ROS 2 Jazzy '
            'installation first'
        )
    if any(importlib.util.find_spec(module) is None for module in ('ensurepip', 'venv')):
        raise SetupError('the Python module venv is missing; on Debian: apt install python3-venv')
    for tool, package in (('g++', 'g++'), ('make', 'make')):
        if shutil.which(tool) is None:
            raise SetupError(f'{tool} is missing; on Debian: apt install {package}')
    header = Path(sysconfig.get_paths()['include']) / 'Python.h'
    if not header.is_file():
        raise SetupError(f'{header} is missing; on Debian: apt install python3-dev')


def check_room() -> None:
    """Say before the first byte that the disk is too small.

    Raises:
        SetupError: naming what is free and what is needed.
    """
    free = shutil.disk_usage(ROOT).free
    if free < NEEDED:
        raise SetupError(
            f'{free / 1e9:.1f} GB are free on the disk of {ROOT}, {NEEDED / 1e9:.0f} GB are '
            'needed: make room, then run the command again'
        )
