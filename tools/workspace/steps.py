# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The steps of set-up, in order."""

import errno
import sys

from workspace.base import CACHE, ROOT, SetupError
from workspace.build import build
from workspace.environment import make_environment
from workspace.kernels import Kernels
from workspace.lock import alone
from workspace.machine import check_machine, sourced_ros
from workspace.plan import need_of
from workspace.prefix import make_prefix


def prepare(*command: str) -> int:
    """Bring the workspace up to date; say nothing when it is.

    Args:
        command: the words after `satvib`; what they do not need is left for later.

    Returns:
        an exit code: 0, 2 when something is missing (said in one line), 130 when interrupted.
    """
    try:
        CACHE.mkdir(exist_ok=True)
        with alone():
            own_ros = sourced_ros()
            check_machine(own_ros)
            make_environment(own_ros)
            make_prefix(own_ros)
            kernels = Kernels(need_of(*command))
            try:
                kernels.start()
                build(own_ros)
                kernels.wait()
            finally:
                kernels.stop()
    except SetupError as error:
        print(f'satvib: {error}', file=sys.stderr)
        return 2
    except OSError as error:
        print(f'satvib: {advice(error)}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print('satvib: set-up interrupted; run the command again to go on', file=sys.stderr)
        return 130
    return 0


def advice(error: OSError) -> str:
    """Say in one line what the system refused, and what to do."""
    where = error.filename or ROOT
    if error.errno in {errno.ENOSPC, errno.EDQUOT}:
        return f'{where}: the disk is full: make room (about 2 GB), then run the command again'
    if error.errno in {errno.EROFS, errno.EACCES, errno.EPERM}:
        return f'{where}: {error.strerror}; satvib writes into its own folder {ROOT}: make it writable, or copy it'
    return f'{where}: {error.strerror}'
