# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Frames on the wire. Truth: PyPI's cobs, the CRC's published check value, and what was sent."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_daq_bridge.protocol.cobs import CobsError, decode, encode
from satvib_daq_bridge.protocol.framing import LONGEST_PAYLOAD, FrameReader, crc16, frame
from satvib_daq_bridge.protocol.messages import (
    Command,
    Configure,
    Configured,
    Flag,
    Hello,
    Hold,
    Identity,
    Refusal,
    Sample,
    Stop,
    Zero,
    newer,
    pack,
    parse,
)

reference = pytest.importorskip('cobs.cobs', reason='cobs is missing: pip install cobs')

MESSAGES = [
    Hello(0, 7),
    Identity(9, 7, 1, 6, 3, 12, -5_000_000, 5_000_000, -10_000_000, 10_000_000, 500_000, 'x' * 16),
    Configure(9, 1, 10_000_000, 30_000, Hold.LINEAR, 6, (10_000_000, 1, 0)),
    Configured(9, 1, Refusal.LIFETIME),
    Command(65535, 2**32 - 1, 2**32 - 1, True, (-(2**31), 2**31 - 1, 0)),
    Zero(0, 0),
    Stop(1, 2),
    Sample(9, 12, 4_000_000_000, Flag.ENABLED | Flag.OVERRUN, 11, 1, 2, 3, (-1, 2, -3, 4, -5, 6)),
]


@settings(max_examples=300, deadline=None)
@given(st.one_of(st.binary(max_size=600), st.lists(st.sampled_from([0, 1, 254, 255])).map(bytes)))
def test_cobs_equals_the_reference(data):
    assert encode(data) == reference.encode(data)
    assert decode(encode(data)) == data


@pytest.mark.parametrize('length', [0, 1, 253, 254, 255, 507, 508, 509, 762])
@pytest.mark.parametrize('zero_at', [None, 0, 253, 254, 255, -1])
def test_cobs_equals_the_reference_where_blocks_end(length, zero_at):
    data = bytearray(1 + i % 255 for i in range(length))
    if zero_at is not None and -len(data) <= zero_at < len(data):
        data[zero_at] = 0
    assert encode(bytes(data)) == reference.encode(bytes(data))
    assert decode(encode(bytes(data))) == data


@settings(max_examples=300, deadline=None)
@given(st.binary(max_size=40))
def test_cobs_refuses_what_the_reference_refuses(data):
    try:
        expected = reference.decode(data)
    except reference.DecodeError:
        with pytest.raises(CobsError):
            decode(data)
    else:
        assert decode(data) == expected


def test_crc_check_value():
    """Truth: the catalogue of CRC algorithms, CRC-16/IBM-3740 (CCITT, initial value 0xFFFF): 0x29B1."""
    assert crc16(b'123456789') == 0x29B1


@pytest.mark.parametrize('message', MESSAGES, ids=lambda m: type(m).__name__)
def test_a_message_survives_the_wire(message):
    (payload,) = FrameReader().feed(frame(pack(message)))
    assert parse(payload) == message


@pytest.mark.parametrize('message', MESSAGES, ids=lambda m: type(m).__name__)
def test_a_message_of_another_length_is_none(message):
    payload = pack(message)
    for cut in range(len(payload)):
        assert parse(payload[:cut]) is None
    assert parse(payload + b'\1') is None


@settings(max_examples=300, deadline=None)
@given(st.binary(max_size=80))
def test_any_payload_parses_or_does_not(data):
    """Whatever passes the CRC: `parse` gives a message that packs to the same bytes, or None."""
    message = parse(data)
    if message is not None and not isinstance(message, Identity):
        assert pack(message) == data


def test_the_number_circle():
    """Truth: RFC 1982."""
    assert newer(1, 0)
    assert newer(0, 2**32 - 1)
    assert newer(2**31 - 1, 0)
    assert not newer(2**31, 0)
    assert not newer(5, 5)
    assert not newer(4, 5)


def test_every_single_and_double_bit_error_is_found():
    """Truth: the CRC alone finds up to three wrong bits; a flip in a code byte of COBS makes more of them, which then
    slip through once in 2^16. For this frame none does."""
    payload = pack(Command(9, 5, 4, True, (1_000_000, -2, 0)))
    wire = frame(payload)
    bits = 8 * len(wire)
    for i in range(bits):
        for j in range(i, bits, 1 if i % 8 == 3 else 37):
            damaged = bytearray(wire)
            damaged[i // 8] ^= 1 << i % 8
            if j != i:
                damaged[j // 8] ^= 1 << j % 8
            got = FrameReader().feed(bytes(damaged) + b'\0')
            assert all(p == payload for p in got)


def test_a_frame_may_be_split_and_merged_anywhere():
    payloads = [pack(m) for m in MESSAGES]
    wire = b'\0'.join(frame(p) for p in payloads)
    for size in range(1, 50):
        reader = FrameReader()
        got = [p for i in range(0, len(wire), size) for p in reader.feed(wire[i : i + size])]
        assert got == payloads
    assert FrameReader().feed(wire) == payloads


def test_endless_garbage_takes_no_memory_and_the_next_frame_but_one_is_read():
    reader = FrameReader()
    for _ in range(100):
        assert reader.feed(b'\xa5' * 10_000) == []
    assert len(reader._piece) <= LONGEST_PAYLOAD + 4
    first, second = pack(Hello(1, 1)), pack(Hello(1, 2))
    assert reader.feed(frame(first) + frame(second)) == [second]
    assert (reader.accepted, reader.rejected) == (1, 1)


def damage(rng, wire):
    """One of: flipped bits, lost bytes, inserted bytes, bytes in disorder, noise instead."""
    data = bytearray(wire)
    kind, at = rng.integers(5), int(rng.integers(len(data)))
    if kind == 0:
        for bit in rng.integers(8 * len(data), size=rng.integers(1, 12)):
            data[bit // 8] ^= 1 << bit % 8
    elif kind == 1:
        del data[at : at + int(rng.integers(1, len(data)))]
    elif kind == 2:
        data[at:at] = rng.bytes(int(rng.integers(1, 20)))
    elif kind == 3:
        data[at:] = data[at:][::-1]
    else:
        data = bytearray(rng.bytes(int(rng.integers(1, 60))))
    return bytes(data)


def fuzz(count, seed):
    """Send frames of which a third is damaged, in pieces of any size; gives how many false ones were accepted."""
    rng = np.random.default_rng([seed, 0])
    reader, false, damaged_frames = FrameReader(), 0, 0
    after_damage = False
    for _ in range(count // 100):
        sent, whole, wire = set(), [], b''
        for _ in range(100):
            values = tuple(int(v) for v in rng.integers(-(2**24), 2**24, size=3))
            payload = pack(Command(9, int(rng.integers(2**32)), 0, True, values))
            good = frame(payload)
            sent.add(payload)
            is_damaged = rng.random() < 0.33
            damaged_frames += is_damaged
            if not is_damaged and not after_damage:
                whole.append(payload)
            wire += damage(rng, good) if is_damaged else good
            after_damage = is_damaged
        got, at = [], 0
        while at < len(wire):
            step = int(rng.integers(1, 200))
            got += reader.feed(wire[at : at + step])
            at += step
        false += sum(p not in sent for p in got)
        # resynchronized: only the frame behind a damaged one may be lost with it
        missing = set(whole) - set(got)
        assert not missing
    return false, damaged_frames


def assert_odds(false, damaged):
    """False frames are as rare as 16 bits allow: Poisson with mean damaged / 2^16, five deviations."""
    mean = damaged / 2.0**16
    assert false <= mean + 5.0 * math.sqrt(mean) + 2.0, f'{false} of {damaged}'


def test_fuzz_short():
    false, damaged = fuzz(20_000, 1)
    assert damaged > 6000
    assert_odds(false, damaged)


@pytest.mark.long
def test_fuzz_a_million_frames():
    false, damaged = fuzz(1_000_000, 2)
    assert_odds(false, damaged)
