# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""An acquisition board that is emulated: the reference model of a device, its clock, and a simulated plant."""

import json
import os
import select
import time
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_plant_sim.rig.rig import Rig

from satvib_daq_bridge.protocol.messages import VERSION, Hold, Identity
from satvib_daq_bridge.simulated.bench import Bench
from satvib_daq_bridge.simulated.device import Device

_MICRO = 1_000_000
# bytes that may be unsent before samples are dropped
_ROOM = 4096


def identity_of(rig: Rig) -> Identity:
    """Give the identity of a device with a rig's converters."""
    q, n = rig.acquisition, rig.struts.count
    low, high = round(q.input_range * -_MICRO), round(q.input_range * _MICRO)
    out = round(q.output_range * _MICRO)
    return Identity(
        session=0,
        number=0,
        version=VERSION,
        inputs=2 * n,
        outputs=n,
        bits=q.input_bits,
        input_low=low,
        input_high=high,
        output_low=-out,
        output_high=out,
        shortest_period=500_000,
        name='satvib emulator',
    )


class EmulatedBoard:
    """The device, its clock and its plant.

    Args:
        rig: what is connected to the converters.
        disturbance: as in a scenario.
        seed: of everything random.
        master: descriptor of the device's end of the pseudo-terminal.
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
        # compile now what would delay the first sample
        self.bench.advance(np.zeros(rig.struts.count))
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
            self._receive()
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
        # building the plant takes time that no real device needs
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
        # the plant is sampled on time even when this process is late; the host sees the lateness
        wire = self.device.take_sample(readings, due)
        if len(self._out) + len(wire) > _ROOM:
            self.device.dropped += 1
        else:
            self._out += wire

    def _receive(self) -> None:
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
            event_line = {'t': time.monotonic(), 'event': event, 'why': why}
            os.write(self.log, (json.dumps(event_line) + '\n').encode())
