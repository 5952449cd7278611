# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""An acquisition device that is not there: the serial protocol on a pseudo-terminal, with a simulated rig behind it.

    daq_emulator --rig paper_3dof --link /tmp/satvib0

It does what the firmware does (`protocol.device`), keeps the time like one, and moves a plant by the voltages at its
terminals. The rig's sample rate and hold become those of the session. The plant rests until the outputs are first
enabled in a session; then the disturbance's time begins.

`--log` writes when the outputs were enabled and when they went to 0 V, and why, in seconds of the monotonic clock;
`--truth` saves at the end what the plant really did.
"""

import argparse
import json
import os
import select
import signal
import sys
import time
import tty
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import parse_yaml
from satvib_common.settings_text import parse_settings
from satvib_plant_sim.rig.rig import Rig, load_rig

from satvib_daq_bridge.protocol.messages import Hold, Identity
from satvib_daq_bridge.simulated.bench import Bench
from satvib_daq_bridge.simulated.device import Device

_MICRO = 1_000_000
# bytes that the line may hold back before samples are dropped
_ROOM = 4096


def identity_of(rig: Rig) -> Identity:
    """What a device with a rig's converters says of itself."""
    q, n = rig.acquisition, rig.struts.count
    low, high = round(q.input_range * -_MICRO), round(q.input_range * _MICRO)
    out = round(q.output_range * _MICRO)
    return Identity(
        0, 0, 1, 2 * n, n, q.input_bits, low, high, -out, out, 500_000, 'satvib emulator'
    )


class Emulator:
    """The device, its clock and its plant.

    Args:
        rig: what hangs on the converters.
        disturbance: as in a scenario.
        seed: of everything random.
        master: descriptor of the device's end of the line.
        log: descriptor to write events to; -1 for none.
        keep: whether to keep what the plant really did.
    """

    def __init__(
        self, rig: Rig, disturbance: dict[str, Any], seed: int, master: int, log: int, keep: bool
    ) -> None:
        self.rig, self.disturbance, self.seed = rig, disturbance, seed
        self.device = Device(identity_of(rig))
        self.master, self.log, self.keep = master, log, keep
        self.bench = Bench(rig, disturbance, seed)
        self.bench.advance(
            np.zeros(rig.struts.count)
        )  # compiles now what would stall the first sample
        self.upper: list[Array] = []
        self.lower: list[Array] = []
        self.volts: list[Array] = []
        self.begun_at = -1
        self._session: Any = None
        self._out = b''
        self._taken = 0
        self._arrival: float | None = None
        self._enabled = False
        self._epoch = time.monotonic_ns()

    def now(self) -> int:
        """The device's clock, us."""
        return (time.monotonic_ns() - self._epoch) // 1000

    def run_once(self, longest: float = 0.5) -> None:
        """Wait for what comes first, and do it."""
        now = self.now()
        waits = [longest]
        expires = self.device.expires()
        if expires is not None:
            waits.append((expires - now) / _MICRO)
        if self.device.configured is not None:
            waits.append((self._due() - now) / _MICRO)
        writers = [self.master] if self._out else []
        ready, _, _ = select.select([self.master], writers, [], max(min(waits), 0.0))
        if ready:
            self._hear()
        self.device.watch(self.now())
        self._note()
        if self.device.configured is not self._session:
            self._begin_session()
        while self.device.configured is not None and self.now() >= self._due():
            self._sample()
        self._flush()

    def save(self, path: Path) -> None:
        """Save what the plant really did: (samples, struts, fine) m/s^2 and (samples, struts) V at the coils."""
        np.savez_compressed(
            path,
            upper=np.array(self.upper, dtype=np.float32),
            lower=np.array(self.lower, dtype=np.float32),
            voltage=np.array(self.volts),
            begun_at=self.begun_at,
            sample_rate=self.bench.rig.acquisition.sample_rate,
        )

    def _due(self) -> int:
        setup = self.device.configured
        assert setup is not None
        return self.device.begun + (self.device.samples + 1) * setup.period // 1000

    def _begin_session(self) -> None:
        setup = self._session = self.device.configured
        if setup is None:
            return
        mapping = self.rig.to_mapping()
        mapping['acquisition']['sample_rate'] = 1e9 / setup.period
        mapping['acquisition']['hold'] = Hold(setup.hold).name.lower()
        self.bench = Bench(Rig.from_mapping(mapping, 'emulator'), self.disturbance, self.seed)
        self.upper, self.lower, self.volts = [], [], []
        self.begun_at = -1
        # building the plant takes a moment that no real device takes
        self.device.begun = self.now()

    def _sample(self) -> None:
        setup = self.device.configured
        assert setup is not None
        now, due = self.now(), self._due()
        if now - due >= setup.period // 1000:
            self.device.overrun()
        if self.device.samples > 0:
            volts = np.array(self.device.targets) / _MICRO
            truth = self.bench.advance(volts, self._arrival or 0.0)
            if self.keep:
                self.upper.append(truth.upper)
                self.lower.append(truth.lower)
                self.volts.append(volts * self.rig.coil.gain)
        if self.device.enabled and not self.bench.begun:
            self.bench.begin()
            self.begun_at = self.device.samples
        self._arrival = None
        self._taken = due
        readings = tuple(int(v) for v in np.rint(self.bench.volts() * _MICRO))
        # the plant is sampled on time however late this process is; the host sees the lateness
        wire = self.device.take_sample(readings, due)
        if len(self._out) + len(wire) > _ROOM:
            self.device.dropped += 1
        else:
            self._out += wire

    def _hear(self) -> None:
        try:
            data = os.read(self.master, 65536)
        except OSError:
            data = b''
        now = self.now()
        before = self.device.targets
        self._out += self.device.receive(data, now)
        if self.device.targets != before:
            self._arrival = (now - self._taken) / _MICRO

    def _flush(self) -> None:
        if not self._out:
            return
        try:
            written = os.write(self.master, self._out)
        except BlockingIOError:
            return
        self._out = self._out[written:]

    def _note(self) -> None:
        if self.device.enabled == self._enabled:
            return
        self._enabled = self.device.enabled
        if self.log >= 0:
            event = 'enabled' if self._enabled else 'zero'
            why = '' if self._enabled else self.device.zeroed
            line = {'t': time.monotonic(), 'event': event, 'why': why}
            os.write(self.log, (json.dumps(line) + '\n').encode())


def open_line(link: Path | None) -> tuple[int, int, str]:
    """Make a pseudo-terminal; gives the device's end, the host's end (kept open) and the host's path.

    Raises:
        SatvibError: the link exists already.
    """
    master, slave = os.openpty()
    tty.setraw(slave)
    os.set_blocking(master, False)
    path = os.ttyname(slave)
    if link is not None:
        try:
            link.symlink_to(path)
        except OSError as error:
            raise SatvibError(f'{link}: cannot be made: {error.strerror}') from None
        path = str(link)
    return master, slave, path


def main(arguments: list[str] | None = None) -> int:
    """Run an emulator until SIGTERM or SIGINT."""
    parser = argparse.ArgumentParser(prog='daq_emulator', description=__doc__.splitlines()[0])
    parser.add_argument(
        '--rig', default='paper_3dof', help='name of a rig, or the path of its file'
    )
    parser.add_argument(
        '--set', action='append', default=[], metavar='KEY=VALUE', help='change the rig'
    )
    parser.add_argument('--disturbance', default='kind: none', help='as in a scenario, as YAML')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--link', type=Path, help='path of the port, a link to the pseudo-terminal')
    parser.add_argument('--log', type=Path, help='write when outputs were enabled and zeroed')
    parser.add_argument('--truth', type=Path, help='save what the plant really did (.npz)')
    given = parser.parse_args(arguments)
    try:
        rig = load_rig(given.rig, parse_settings(given.set, '--set'))
        disturbance = parse_yaml(given.disturbance, '--disturbance')
        log = os.open(given.log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC) if given.log else -1
        master, _, path = open_line(given.link)
        emulator = Emulator(rig, disturbance, given.seed, master, log, given.truth is not None)
    except (SatvibError, ValueError, OSError) as error:
        sys.stderr.write(f'daq_emulator: {error}\n')
        return 2
    over = False

    def end(_: int, __: FrameType | None) -> None:
        nonlocal over
        over = True

    signal.signal(signal.SIGTERM, end)
    signal.signal(signal.SIGINT, end)
    sys.stdout.write(f'ready {path}\n')
    sys.stdout.flush()
    while not over:
        emulator.run_once()
    if given.truth:
        emulator.save(given.truth)
    if given.link:
        given.link.unlink(missing_ok=True)
    return 0


if __name__ == '__main__':
    sys.exit(main())
