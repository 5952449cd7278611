# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The serial back end on a real pseudo-terminal, with a device whose every byte passes through the test's hands.

Truth: the rules of docs/serial_protocol.md. What is written and read is real; the device's clock is turned by the test.
"""

import os
import select
from dataclasses import replace

import numpy as np
import pytest
from satvib_daq_bridge.back_ends.base import BackEndError
from satvib_daq_bridge.back_ends.serial_port import PORTION
from satvib_daq_bridge.protocol.framing import frame
from satvib_daq_bridge.protocol.messages import Configure, Hold, parse
from satvib_daq_bridge.simulated.device import Device
from satvib_daq_bridge.simulated.emulated_board import identity_of
from satvib_plant_sim.rig.rig import load_rig

RIG = load_rig('paper_3dof')
PERIOD, LIFETIME = 0.005, 0.02


def test_open_and_start_tell_the_device_what_the_channels_say(new_bench):
    made = new_bench(options={'hold': 'linear'})
    assert 'satvib emulator on /dev/' in made.open()
    setup = made.device.configured
    assert isinstance(setup, Configure)
    assert (setup.period, setup.lifetime, setup.hold) == (5_000_000, 20_000, Hold.LINEAR)
    assert setup.limits == (10_000_000,) * 3
    made.close()


def test_samples_come_in_volts_and_in_time(bench):
    bench.to_host(bench.sample())
    bench.poll()
    bench.to_host(bench.sample(2.5) + bench.sample(-1.25))
    first, second = bench.poll()
    assert (first.sequence, second.sequence) == (1, 2)
    assert second.volts.tolist() == [-1.25] * 6
    assert second.time - first.time == pytest.approx(PERIOD, abs=1e-4)


def test_a_command_reaches_the_terminals(bench):
    bench.to_host(bench.sample())
    bench.poll()
    bench.write([1.0, -2.0, 0.5], 0)
    bench.to_device()
    assert bench.device.targets == (1_000_000.0, -2_000_000.0, 500_000.0)


def test_the_largest_converter_that_a_message_can_name(new_bench):
    """Truth: 2^31 - 1 uV, the most that the protocol holds. A channels file may say a thousandth more."""
    widest = 2**31 - 1
    made = new_bench(coil={'range': [-2149.0, 2149.0], 'gain': 1.0, 'limit': 2149.0, 'slew': 1e7})
    made.device = Device(
        replace(identity_of(RIG), output_low=-widest, output_high=widest)
    )  # fmt: skip
    made.open()
    assert made.device.configured.limits == (widest,) * 3
    made.to_host(made.sample())
    made.poll()
    made.write([2149.0, -2149.0, 0.0], 0)
    made.to_device()
    assert made.device.targets == (widest, -widest, 0.0)
    made.close()


def test_any_split_and_any_merge(bench):
    wire = b''.join(bench.sample() for _ in range(20))
    got = []
    for i in range(0, len(wire), 7):
        bench.to_host(wire[i : i + 7])
        got += [r.sequence for r in bench.poll()]
    assert got == list(range(20))


def test_repeated_and_old_samples_are_dropped_and_lost_ones_are_gaps(bench):
    wires = [bench.sample() for _ in range(6)]
    for wire in (wires[0], wires[1], wires[1], wires[0], wires[4], wires[3], wires[5]):
        bench.to_host(wire)
    assert [r.sequence for r in bench.poll()] == [0, 1, 4, 5]
    assert bench.back_end.figures()['samples lost'] == 2


@pytest.mark.parametrize('seed', range(3))
def test_bit_flips_and_garbage_never_make_a_sample(bench, seed):
    """What is accepted was sent, unchanged; a sound frame behind a damaged one that took its zero byte may be lost, the
    next never."""
    rng = np.random.default_rng([seed, 0])
    sound, got = [], []
    before_damaged = False
    for k in range(600):
        volts = float(rng.integers(-5_000_000, 5_000_000)) / 1e6
        wire = bench.sample(volts)
        damaged = rng.random() < 0.3
        if damaged:
            data = bytearray(wire)
            for bit in rng.integers(8 * len(data), size=rng.integers(1, 9)):
                data[bit // 8] ^= 1 << bit % 8
            wire = bytes(data) if rng.random() < 0.8 else rng.bytes(int(rng.integers(1, 40)))
        elif not before_damaged:
            sound.append((k, volts))
        before_damaged = damaged
        bench.to_host(wire)
        got += [(r.sequence, r.volts[0]) for r in bench.poll()]
    assert set(sound) <= set(got)
    assert [k for k, _ in got] == sorted({k for k, _ in got})
    assert len(got) < 600


def test_an_attack_on_the_commands_never_drives_beyond_the_lifetime(bench):
    """Truth: the device follows a command that arrives whole; when all are damaged, 0 V after 20 ms."""
    rng = np.random.default_rng([9, 0])
    driven = 0
    for k in range(400):
        bench.to_host(bench.sample())
        bench.poll()
        bench.write([1.0, 1.0, 1.0], k)
        data = bytearray(bench.from_host())
        attacked = k % 100 >= 50
        if attacked and data:
            # three wrong bits at most behind COBS' own bytes: the CRC finds all of them
            data[int(rng.integers(1, len(data) - 1))] ^= 1 << int(rng.integers(8))
        bench.device.receive(bytes(data), bench.now)
        bench.device.watch(bench.now)
        if k % 100 >= 55:
            assert bench.device.targets == (0.0,) * 3
        driven += bench.device.enabled
        if k % 100 == 99:
            bench.write([0.0] * 3, k, enable=False)
            bench.to_device()
    assert driven >= 200


def test_a_slow_reader_costs_samples_and_no_time(bench):
    """The host reads nothing until the line is full and longer: whole frames are dropped; then the host is in step
    again, with gaps and without half a frame."""
    kept, dropped = b'', 0
    while dropped < 100:
        wire = bench.sample()
        dropped += bool(kept)
        kept = bench.to_host(kept or wire)
    got = []
    while more := bench.poll():
        got += more
        kept = bench.to_host(kept)
    bench.to_host(bench.sample())
    bench.to_host(bench.sample())
    got = [r.sequence for r in got + bench.poll()]
    assert got[-1] == bench.device.samples - 1
    assert got == sorted(set(got))
    figures = bench.back_end.figures()
    assert figures['frames rejected'] == 0
    assert figures['samples lost'] == bench.device.samples - len(got)


def test_a_device_that_reads_nothing_never_blocks_the_host(bench):
    """Commands are given up, and the first one after the stall is whole and the newest."""
    bench.to_host(bench.sample())
    bench.poll()
    for i in range(4000):
        bench.write([i * 1e-3] * 3, 0)
    assert bench.back_end.given_up > 100
    rejected = bench.device.reader.rejected
    while data := bench.from_host():
        bench.device.receive(data, bench.now)
        bench.back_end.poll(0.0)
    bench.write([0.25] * 3, 0)
    bench.to_device()
    assert bench.device.targets == (250_000.0,) * 3
    assert bench.device.reader.rejected == rejected


def test_unplugging_is_reported(bench):
    os.close(bench.master)
    os.close(bench.slave)
    bench.master = bench.slave = -1
    with pytest.raises(BackEndError, match='the line is gone'):
        bench.back_end.poll(0.0)
    bench.back_end.zero()  # says nothing, for there is nobody


def test_a_device_that_expired_while_driven_is_a_fault(bench):
    bench.to_host(bench.sample())
    bench.poll()
    bench.write([1.0] * 3, 0)
    bench.to_device()
    for _ in range(5):
        bench.to_host(bench.sample())
    assert 'no command within its lifetime' in bench.poll()[-1].fault


def test_an_open_enable_chain_while_driven_is_a_fault(bench):
    """Truth: the device latches 0 V and refuses to be driven until the chain is closed and a disabled command came."""
    bench.to_host(bench.sample())
    bench.poll()
    bench.write([1.0] * 3, 0)
    bench.to_device()
    bench.device.chain(closed=False)
    assert bench.device.targets == (0.0,) * 3
    bench.to_host(bench.sample())
    assert bench.poll()[-1].fault == 'the enable chain is open'
    steps = [
        (False, False, 0),
        (False, True, 0),
        (True, True, 0),
        (True, False, 0),
        (True, True, 1),
    ]
    for closed, enable, moved in steps:
        bench.device.chain(closed)
        bench.write([1.0] * 3, 1, enable)
        bench.to_device()
        assert bench.device.targets == (moved * 1e6,) * 3


def test_one_impossible_number_is_not_used_and_many_are_a_fault(bench):
    """Truth: a device that samples each 5 ms cannot be 2^31 - 100 samples ahead after one period."""
    wires = [bench.sample() for _ in range(3)]
    good = bench.device.samples
    bench.device.samples = 2**31 - 100
    ahead = [bench.sample() for _ in range(10)]
    bench.device.samples = good
    for wire in (*wires, ahead[0], bench.sample()):
        bench.to_host(wire)
    assert [r.sequence for r in bench.poll()] == [0, 1, 2, 3]
    assert bench.back_end.figures()['samples with an impossible number'] == 1
    for wire in ahead:
        bench.to_host(wire)
    with pytest.raises(BackEndError, match='numbers its samples wrongly'):
        bench.poll()


def test_a_flood_is_read_in_portions(bench):
    """Truth: what one turn reads is bounded, so a flood cannot hold a voltage back; nothing is lost by it."""
    flood = np.random.default_rng([5, 0]).bytes(3000) + b'\0' + bench.sample(1.5)
    rest = bench.to_host(flood)
    assert not rest
    turns, got = 0, []
    while select.select([bench.back_end.fileno()], [], [], 0.05)[0]:
        got += bench.back_end.poll(bench.now / 1e6 + 0.001)
        turns += 1
    assert turns >= len(flood) // PORTION
    assert [r.volts[0] for r in got] == [1.5]


def test_zero_needs_no_session(bench):
    bench.to_host(bench.sample())
    bench.poll()
    bench.write([1.0] * 3, 0)
    bench.to_device()
    bench.device.configured = Configure(1, 1, 5_000_000, 20_000, Hold.ZERO, 6, (10_000_000,) * 3)
    bench.back_end.zero()
    bench.to_device()
    assert bench.device.targets == (0.0,) * 3


def test_a_new_opener_zeroes_what_a_killed_one_left(bench):
    """The line holds half a frame, the device a voltage: `open` ends the one and zeroes the other first."""
    bench.to_host(bench.sample())
    bench.poll()
    bench.write([1.0] * 3, 0)
    bench.to_device()
    os.write(bench.back_end.fileno(), frame(b'half a frame')[:5])
    bench.back_end._port.close()
    bench.open()
    assert bench.device.targets == (0.0,) * 3


def test_lateness_of_the_host_is_not_taken_for_the_devices(bench):
    """Truth: the device samples each 5 ms; a frame that is read 30 ms late is told as 30 ms late, not as a late
    sample."""
    for _ in range(5):
        bench.to_host(bench.sample())
        bench.poll()
    bench.to_host(bench.sample())
    (reading,) = bench.poll(late=0.03)
    assert reading.late == pytest.approx(0.03, abs=1e-4)
    assert reading.time == pytest.approx(bench.now / 1e6 + 0.001, abs=1e-4)


def test_numbers_and_clocks_wrap(bench):
    bench.device.samples = 2**32 - 3
    bench.back_end._sequence = 2**32 - 4
    bench.now = 2**32 - 12_000
    got = []
    for _ in range(6):
        bench.to_host(bench.sample())
        got += bench.poll()
    assert [r.sequence for r in got] == [2**32 - 3 + i for i in range(6)]
    steps = np.diff([r.time for r in got])
    np.testing.assert_allclose(steps, PERIOD, atol=2e-5)
    bench.write([1.0] * 3, got[-1].sequence)
    bench.to_device()
    assert bench.device.targets[0] == 1_000_000.0


def test_every_frame_of_a_session_parses(bench):
    for k in range(10):
        bench.to_host(bench.sample())
        bench.poll()
        bench.write([0.1] * 3, k)
    payloads = bench.heard.feed(bench.from_host())
    assert len(payloads) == 10
    assert all(parse(p) is not None for p in payloads)
