# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Controller and identifier of one strut in one process: what a module of the rig runs.

    ros2 run satvib_bringup strut --ros-args -r __ns:=/strut_1 -p strut_controller:law:=narrowband

The two nodes keep their names, topics, parameters and services. What the controller answers never waits for the
identifier.
"""

from satvib_common.ros.main import run_nodes
from satvib_control.nodes.strut_controller_node import StrutControllerNode
from satvib_ident.nodes.strut_identifier_node import StrutIdentifierNode


def main() -> None:
    """Run both nodes."""
    run_nodes([StrutControllerNode, StrutIdentifierNode])


if __name__ == '__main__':
    main()
