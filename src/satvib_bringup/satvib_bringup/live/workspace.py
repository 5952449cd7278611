# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where the built workspace keeps what is started, and the environment in which it is started."""

import os
from pathlib import Path

from ament_index_python.packages import (
    PackageNotFoundError,
    get_package_prefix,
    get_packages_with_prefixes,
)
from satvib_common.errors import SatvibError
from satvib_common.transport.reach import set_transport


def executable(package: str, name: str) -> Path:
    """Path of an installed executable.

    Raises:
        SatvibError: the workspace is not built or not sourced.
    """
    try:
        path = Path(get_package_prefix(package), 'lib', package, name)
    except (PackageNotFoundError, LookupError):
        raise SatvibError(
            f'{package}: not found; build the workspace and source install/setup.bash, or use '
            './satvib, which does both'
        ) from None
    if not path.is_file():
        raise SatvibError(f'{path}: missing; build the workspace again with colcon build')
    return path


def executables() -> dict[str, list[str]]:
    """Installed executables of the packages of satvib, by package; packages without one are left out."""
    found = {}
    for package, prefix in get_packages_with_prefixes().items():
        folder = Path(prefix, 'lib', package)
        if package.startswith('satvib_') and folder.is_dir():
            names = [path.name for path in folder.iterdir() if os.access(path, os.X_OK)]
            found[package] = sorted(set(names) - {'satvib'})
    return {package: names for package, names in found.items() if names}


def graph_environment() -> dict[str, str]:
    """Environment of the graph's processes.

    One computing thread each, for nine processes share the machine, and the transport that the user's settings ask for.
    """
    found = dict(os.environ)
    for name in ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS', 'NUMBA_NUM_THREADS'):
        found.setdefault(name, '1')
    set_transport(found)
    found['PYTHONUNBUFFERED'] = '1'
    return found
