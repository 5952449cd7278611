# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The reference firmware against the Python model: the same bytes in, the same bytes out, at the same times.

Truth: each is the other's; the rules themselves are tested in test_device. Outputs that move agree within 3 uV, for the
firmware counts in whole microvolts.
"""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from satvib_daq_bridge.protocol.framing import FrameReader, frame
from satvib_daq_bridge.protocol.messages import (
    Command,
    Configure,
    Hello,
    Hold,
    Identity,
    Sample,
    Stop,
    Zero,
    pack,
    read_stream,
)
from satvib_daq_bridge.simulated.device import Device

HERE = Path(__file__).parent
SKETCH = HERE.parents[1] / 'firmware' / 'satvib_device'
COMPILER = shutil.which('g++')
FLAGS = ['-std=c++17', '-Wall', '-Wextra', '-Wshadow', '-Werror', f'-I{SKETCH}']
needs_compiler = pytest.mark.skipif(not COMPILER, reason='g++ is missing: apt install g++')

IDENTITY = Identity(
    0, 0, 1, 6, 3, 12, -5_000_000, 5_000_000, -10_000_000, 10_000_000, 500_000, 'test'
)
INPUTS = (1, -2, 3, -4, 5, -6)


# an error of memory or of arithmetic that the language leaves undefined ends the program
SANITIZERS = ['-fsanitize=address,undefined', '-fno-sanitize-recover=all', '-g']


@pytest.fixture(scope='module')
def program(tmp_path_factory):
    path = tmp_path_factory.mktemp('firmware') / 'host'
    subprocess.run(
        [COMPILER, *FLAGS, *SANITIZERS, '-O1', '-o', path, HERE / 'firmware' / 'host.cpp'],
        check=True,
    )
    return path


class Firmware:
    def __init__(self, program):
        self.process = subprocess.Popen(
            [program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def tell(self, what, now, data=b''):
        self.process.stdin.write(f'{what} {now & 0xFFFFFFFF} {data.hex()}\n')
        self.process.stdin.flush()
        return self.process.stdout.readline().strip()

    def close(self):
        self.process.stdin.close()
        assert self.process.wait(30) == 0, 'a sanitizer has ended the program'


def messages(rng, device):
    """What a host might send, and what it might not."""
    number = int(rng.integers(0, 30))
    newest = max(device.samples - 1, 0)
    choice = rng.integers(12)
    if choice == 0:
        return Hello(int(rng.integers(3)), number)
    if choice == 1:
        # up to the most that a channels file can ask for: 2147 V
        largest = int(rng.choice([10_000_000, 1_073_741_824, 2**31 - 1]))
        limits = tuple(
            int(v) for v in rng.integers(-200_000, largest, size=rng.choice([2, 3, 3, 3]))
        )
        period = int(rng.choice([400_000, 5_000_000, 10_000_000]))
        lifetime = int(rng.choice([0, 20_000, 60_000], p=[0.1, 0.8, 0.1]))
        return Configure(
            int(rng.integers(1, 3)), number, period, lifetime, Hold(int(rng.integers(2))),
            int(rng.integers(5, 8)), limits,
        )  # fmt: skip
    if choice == 2 and rng.random() < 0.3:
        return Zero() if rng.random() < 0.7 else Stop()
    sample = (newest - int(rng.integers(-1, 7))) & 0xFFFFFFFF
    volts = tuple(int(v) for v in rng.integers(-(2**31), 2**31, size=rng.choice([1, 3, 3, 3, 3])))
    order = (device._command + int(rng.integers(-1, 4))) & 0xFFFFFFFF
    return Command(int(rng.integers(1, 3)), order, sample, bool(rng.random() < 0.8), volts)


@needs_compiler
@pytest.mark.parametrize('seed', range(4))
def test_the_firmware_does_what_the_model_does(program, seed):
    rng = np.random.default_rng([seed, 0])
    model, firmware = Device(IDENTITY), Firmware(program)
    now = 2**32 - 200_000  # the clock of the board wraps on the way
    moved = 0
    setup = frame(pack(Configure(1, 1, 5_000_000, 20_000, Hold.LINEAR, 6, (9_000_000,) * 3)))
    wires = [setup]
    for _ in range(2000):
        now += int(rng.integers(0, 4000))
        wire = wires.pop() if wires else frame(pack(messages(rng, model)))
        if rng.random() < 0.1:
            damaged = bytearray(wire)
            damaged[int(rng.integers(len(wire)))] = int(rng.integers(256))
            wire = bytes(damaged)
        elif rng.random() < 0.05:
            wire = rng.bytes(int(rng.integers(400)))
        assert firmware.tell('r', now, wire) == model.receive(wire, now).hex()
        if rng.random() < 0.7:
            now += int(rng.integers(0, 2000))
            assert firmware.tell('s', now) == model.take_sample(INPUTS, now).hex()
        closed = bool(rng.random() < 0.999)
        firmware.tell('c', now, bytes([closed]))
        model.chain(closed)
        now += int(rng.integers(0, 3000))
        firmware.tell('w', now)
        model.watch(now)
        got = np.array([float(v) for v in firmware.tell('o', now).split(',')])
        np.testing.assert_allclose(got, model.outputs(now), rtol=0, atol=3.0)
        moved += got.any()
    firmware.close()
    assert moved > 100, 'the outputs hardly ever moved: the test shows nothing'


@needs_compiler
@pytest.mark.parametrize(
    'limits',
    [
        *[(v,) * 3 for v in (0, 1, 10_000_000, 1_073_741_823, 1_073_741_824, 2**31 - 1)],
        *np.exp(np.random.default_rng(7).uniform(0.0, np.log(2**31), (12, 3))).astype(int).tolist(),
    ],
    ids=str,
)
def test_outputs_move_from_end_to_end_without_overflow(program, limits):
    """Truth: a straight line between the ends, in whole uV, for limits up to what a file accepts, 2^31 - 1 uV.

    What is asked for lies beyond the limit where a message can say it.
    """
    firmware = Firmware(program)
    period = 4_000_000
    setup = Configure(1, 1, period, 50_000, Hold.LINEAR, 6, tuple(limits))
    firmware.tell('r', 0, frame(pack(setup)))
    now = 0
    before = np.zeros(3)
    for number, sign in enumerate((1, -1, 1), start=1):
        asked = tuple(sign * min(2 * limit, 2**31 - 1) for limit in limits)
        end = sign * np.array(limits, dtype=float)
        firmware.tell('s', now)
        firmware.tell('r', now, frame(pack(Command(1, number, number - 1, True, asked))))
        for share in (0, 1, 2, 3, 4):
            got = [int(v) for v in firmware.tell('o', now + 1000 * share).split(',')]
            assert got == pytest.approx(before + (end - before) * share / 4, abs=1.0)
        now += 4000
        before = end
    firmware.close()


@needs_compiler
def test_the_sketch_compiles_without_a_warning():
    subprocess.run(
        [
            COMPILER, *FLAGS, f'-I{HERE / "firmware"}', '-fsyntax-only', '-x',
            'c++', SKETCH / 'satvib_device.ino',
        ],
        check=True,
    )  # fmt: skip


@needs_compiler
def test_the_first_samples_of_a_session_are_those_of_a_sensor_at_rest(tmp_path):
    """A filter that begins at 0 V would show the bridge a step, and no bias could be learnt from it.

    Truth: what the ADC reads, 2.5 V, in uV; to 2 uV, as the filter counts in doubles and the wire in whole uV.
    """
    program = tmp_path / 'sketch'
    sources = [f'-I{HERE / "firmware"}', HERE / 'firmware' / 'sketch.cpp']
    subprocess.run([COMPILER, *FLAGS, '-O1', '-o', program, *sources], check=True)
    code, samples = 1552, 20
    for rate in (50, 200, 1000):
        setup = Configure(1, 1, 10**9 // rate, 50_000, Hold.LINEAR, 6, (9_000_000,) * 3)
        asked = [str(code), frame(pack(setup)).hex(), str((samples + 2) * 10**6 // rate)]
        said = subprocess.run([program, *asked], check=True, capture_output=True, text=True).stdout
        heard = read_stream(FrameReader(), bytes.fromhex(said))
        found = [m for m in heard if isinstance(m, Sample)]
        assert [m.number for m in found[:samples]] == list(range(samples))
        read = code * 2.0 * 3.3e6 / 4096.0
        np.testing.assert_allclose([m.inputs for m in found], read, rtol=0, atol=2.0)
