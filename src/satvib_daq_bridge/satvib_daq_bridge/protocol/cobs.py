# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Consistent overhead byte stuffing: frames without a zero byte, so that zero can end them.

Cheshire and Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Trans. Networking 7 (1999) 159. A code byte n stands
for n - 1 bytes that follow and then a zero, except 255 (254 bytes, no zero); the zero of the last block is left out.
"""

_LONGEST = 254


class CobsError(ValueError):
    """Bytes that are no valid encoding."""


def encode(data: bytes) -> bytes:
    """Stuff any bytes; the result holds no zero."""
    out = bytearray()
    blocks = data.split(b'\0')
    for i, block in enumerate(blocks):
        rest = block
        while len(rest) >= _LONGEST:
            out.append(_LONGEST + 1)
            out += rest[:_LONGEST]
            rest = rest[_LONGEST:]
        # a full block carries no zero, so no block follows when it ends the data
        if rest or i + 1 < len(blocks) or not block:
            out.append(len(rest) + 1)
            out += rest
    return bytes(out)


def decode(data: bytes) -> bytes:
    """Undo `encode`.

    Raises:
        CobsError: a zero within, or a block that ends too early.
    """
    out = bytearray()
    at, end = 0, len(data)
    while at < end:
        code = data[at]
        block = data[at + 1 : at + code]
        if code == 0 or len(block) != code - 1 or 0 in block:
            raise CobsError('a zero byte or a block that ends too early')
        out += block
        at += code
        if code <= _LONGEST and at < end:
            out.append(0)
    return bytes(out)
