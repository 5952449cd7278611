# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back ends: one module for each kind of converter board, loaded when it is used."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_daq_bridge.back_ends.base import BackEnd, BackEndError, EndOfRecordError, Reading
    from satvib_daq_bridge.back_ends.factory import make_back_end

__all__ = ['BackEnd', 'BackEndError', 'EndOfRecordError', 'Reading', 'make_back_end']
__getattr__, __dir__ = door(__name__, __file__)
