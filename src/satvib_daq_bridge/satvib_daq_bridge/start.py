# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where the executables of this package begin, see `satvib_common.process.start`."""

from satvib_common.process.start import starter

daq_bridge = starter('satvib_daq_bridge.nodes.daq_bridge_node')
daq_emulator = starter('satvib_daq_bridge.simulated.emulator')
