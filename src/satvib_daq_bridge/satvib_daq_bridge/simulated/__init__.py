# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Devices that are simulated: a bench, an emulated board, and the channels of a rig."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_daq_bridge.simulated.bench import Bench
    from satvib_daq_bridge.simulated.channels_from_rig import channels_of
    from satvib_daq_bridge.simulated.device import Device
    from satvib_daq_bridge.simulated.emulated_board import EmulatedBoard

__all__ = ['Bench', 'Device', 'EmulatedBoard', 'channels_of']
__getattr__, __dir__ = door(__name__, __file__)
