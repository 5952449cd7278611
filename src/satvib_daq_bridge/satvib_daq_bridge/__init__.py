# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Real hardware in the place of the simulated plant: channels, states, output guard, back ends."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_daq_bridge.back_ends.base import BackEnd, BackEndError, Reading
    from satvib_daq_bridge.back_ends.factory import make_back_end
    from satvib_daq_bridge.bridge.bridge import Bridge
    from satvib_daq_bridge.bridge.session import Session
    from satvib_daq_bridge.channels import Channels, load_channels, parse_channels
    from satvib_daq_bridge.guardian.child_process import GuardianProcess
    from satvib_daq_bridge.guardian.output_guard import OutputGuard
    from satvib_daq_bridge.parameters import BridgeParameters
    from satvib_daq_bridge.simulated.channels_from_rig import channels_of
    from satvib_daq_bridge.states import State, StateMachine, Transition

__all__ = [
    'BackEnd',
    'BackEndError',
    'Bridge',
    'BridgeParameters',
    'Channels',
    'GuardianProcess',
    'OutputGuard',
    'Reading',
    'Session',
    'State',
    'StateMachine',
    'Transition',
    'channels_of',
    'load_channels',
    'make_back_end',
    'parse_channels',
]
__getattr__, __dir__ = door(__name__, __file__)
