# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Make the workspace ready: virtual environment, ROS 2 prefix, colcon build, kernels. Standard library only.

Every step leaves a stamp of what it was made from and is skipped while that is unchanged. Two ways to ROS 2 Jazzy:

* a sourced installation (ROS_DISTRO is set): the virtual environment sits on top of it and adds Python tools only;
* none: the pinned ROS 2 wheels make the virtual environment itself the ROS prefix.

What each step does, and what can go wrong: docs/setup.md.
"""

import sys
from pathlib import Path

# started with -I, which leaves this folder out of the path
sys.path.insert(0, str(Path(__file__).resolve().parent))

from workspace.steps import prepare

if __name__ == '__main__':
    sys.exit(prepare(*sys.argv[1:]))
