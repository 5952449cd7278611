# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The process that owns the outputs, and its link to the bridge."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_daq_bridge.guardian.child_process import GuardianProcess
    from satvib_daq_bridge.guardian.coil_load import CoilLoad
    from satvib_daq_bridge.guardian.guardian import Guardian
    from satvib_daq_bridge.guardian.link import Link, Taken, ToBridge, ToGuardian
    from satvib_daq_bridge.guardian.output_guard import Output, OutputGuard

__all__ = [
    'CoilLoad',
    'Guardian',
    'GuardianProcess',
    'Link',
    'Output',
    'OutputGuard',
    'Taken',
    'ToBridge',
    'ToGuardian',
]
__getattr__, __dir__ = door(__name__, __file__)
