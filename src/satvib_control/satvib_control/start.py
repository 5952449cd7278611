# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where the executables of this package begin, see `satvib_common.process.start`."""

from satvib_common.process.start import starter

strut_controller = starter('satvib_control.nodes.strut_controller_node')
supervisor = starter('satvib_control.nodes.supervisor_node')
centralized_controller = starter('satvib_control.nodes.centralized_controller_node')
