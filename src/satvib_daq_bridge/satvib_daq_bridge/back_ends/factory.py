# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Makes the back end that the channels name: module `back_ends/<name>.py`, imported when it is used.

So a library that is not installed is a fault for those alone who use its back end.
"""

import importlib

from satvib_daq_bridge.back_ends.base import BackEnd
from satvib_daq_bridge.channels import Channels


def make_back_end(channels: Channels, period: float, lifetime: float) -> BackEnd:
    """Build the back end that the channels name; nothing is opened yet.

    Args:
        channels: checked channels; `BACK_ENDS` are the names.
        period: s, sample period.
        lifetime: s, how long a device with a watchdog of its own keeps a command.

    Raises:
        SatvibError: options or channels that the back end cannot do, or a library that is not there.
    """
    module = importlib.import_module(f'satvib_daq_bridge.back_ends.{channels.back_end}')
    made: BackEnd = module.make(channels, period, lifetime)
    return made
