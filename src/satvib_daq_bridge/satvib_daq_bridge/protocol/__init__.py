# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The serial protocol between a bridge and a microcontroller, as in docs/serial_protocol.md."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_daq_bridge.protocol.framing import FrameReader, crc16, frame
    from satvib_daq_bridge.protocol.messages import Message, pack, parse, read_stream, to_wire

__all__ = ['FrameReader', 'Message', 'crc16', 'frame', 'pack', 'parse', 'read_stream', 'to_wire']
__getattr__, __dir__ = door(__name__, __file__)
