# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What decides when a back end takes a sample: a clock of the host, or the answers."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_daq_bridge.back_ends.pace.paced import PACES, Paced
    from satvib_daq_bridge.back_ends.pace.polled import Polled
    from satvib_daq_bridge.back_ends.pace.ticker import Ticker

__all__ = ['PACES', 'Paced', 'Polled', 'Ticker']
__getattr__, __dir__ = door(__name__, __file__)
