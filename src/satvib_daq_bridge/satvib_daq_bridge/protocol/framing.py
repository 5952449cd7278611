# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The bytes on the wire: frames from payloads, and payloads from the bytes that arrive.

    wire = COBS(payload, CRC) 0,   CRC-16/CCITT of the payload: polynomial 0x1021, initial value 0xFFFF, no reflection,
                                   no final inversion; check value of '123456789' is 0x29B1; low byte first

A receiver throws away everything between two zero bytes that is not one whole frame with a right CRC. So it is in step
again after the first zero byte, and damage costs the damaged frame and at most the one that it ran into.
"""

import binascii

from satvib_daq_bridge.protocol.cobs import CobsError, decode, encode

LONGEST_PAYLOAD = 240
_LONGEST_FRAME = LONGEST_PAYLOAD + 4
_CRC_SIZE = 2


def crc16(data: bytes) -> int:
    """Give the CRC-16/CCITT of some bytes."""
    return binascii.crc_hqx(data, 0xFFFF)


def frame(payload: bytes) -> bytes:
    """Make the bytes on the wire of a payload (at most `LONGEST_PAYLOAD` bytes)."""
    if not 0 < len(payload) <= LONGEST_PAYLOAD:
        raise ValueError(f'a payload of {len(payload)} bytes; 1 to {LONGEST_PAYLOAD} are possible')
    return encode(payload + crc16(payload).to_bytes(_CRC_SIZE, 'little')) + b'\0'


class FrameReader:
    """Finds payloads in a stream of bytes.

    Attributes:
        accepted: frames so far.
        rejected: pieces between zero bytes that were no whole frame with a right CRC.
    """

    def __init__(self) -> None:
        self.accepted = 0
        self.rejected = 0
        self._piece = bytearray()
        self._too_long = False

    def feed(self, data: bytes) -> list[bytes]:
        """Take what arrived, in pieces of any size; gives the payloads that are complete with it."""
        found = []
        *ended, rest = data.split(b'\0')
        for piece in ended:
            self._append(piece)
            payload = self._close()
            if payload is not None:
                found.append(payload)
        self._append(rest)
        return found

    def _append(self, piece: bytes) -> None:
        if len(self._piece) + len(piece) > _LONGEST_FRAME:
            self._too_long = True
            self._piece.clear()
        elif not self._too_long:
            self._piece += piece

    def _close(self) -> bytes | None:
        piece, too_long = bytes(self._piece), self._too_long
        self._piece.clear()
        self._too_long = False
        if not piece and not too_long:
            return None  # two zero bytes in a row are no frame, and no harm
        payload = None if too_long else _opened(piece)
        if payload is None:
            self.rejected += 1
        else:
            self.accepted += 1
        return payload


def _opened(piece: bytes) -> bytes | None:
    try:
        data = decode(piece)
    except CobsError:
        return None
    payload = data[:-_CRC_SIZE]
    if not payload or crc16(payload) != int.from_bytes(data[-_CRC_SIZE:], 'little'):
        return None
    return payload
