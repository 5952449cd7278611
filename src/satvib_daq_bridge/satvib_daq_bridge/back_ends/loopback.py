# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back end `loopback`: a simulated plant in the guardian's own process, for trying everything without hardware.

With `pace: lockstep` sample k + 1 comes when sample k has been answered: no clock, the same bits every time. With
`pace: realtime` it comes when its time has come, and the arrival of the voltages is measured.

The device is any one name. Input i is the upper sensor of strut i, input n + i its lower sensor, output i its coil.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from satvib_common.schema import Schema, param
from satvib_plant_sim.rig import load_rig

from satvib_daq_bridge.back_ends.base import (
    Array,
    BackEnd,
    Reading,
    check_indices,
    options_of,
    single_device,
)
from satvib_daq_bridge.back_ends.ticker import Ticker
from satvib_daq_bridge.bench import Bench
from satvib_daq_bridge.channels import Channels


@dataclass(frozen=True, kw_only=True)
class Options(Schema):
    """Settings of the loopback."""

    rig: str = param('paper_3dof', 'name of a rig, or the path of its file')
    rig_overrides: dict[str, Any] = param(dict, 'changes to the rig by dotted key')
    disturbance: dict[str, Any] = param(dict, 'what shakes the rig once a run begins')
    seed: int = param(1, 'seed of everything random', minimum=0)
    pace: str = param('realtime', 'who keeps the time', choices=('realtime', 'lockstep'))


class Loopback(BackEnd):
    """The plant as a device."""

    def __init__(
        self, channels: Channels, period: float, lifetime: float, options: Options
    ) -> None:
        super().__init__(channels, period, lifetime)
        single_device(channels)
        rig = load_rig(options.rig, options.rig_overrides)
        self.bench = Bench(rig, options.disturbance, options.seed)
        self.bench.check_rate(1.0 / period)
        check_indices(channels.where, channels.inputs, 2 * self.bench.struts, 'input')
        check_indices(channels.where, channels.outputs, self.bench.struts, 'output')
        self.virtual = options.pace == 'lockstep'
        self._inputs = np.array([c.index for _, c in channels.inputs])
        self._outputs = np.array([c.index for _, c in channels.outputs])
        self._ticker = Ticker(period)
        self._sequence = -1
        self._volts = np.zeros(self.bench.struts)
        self._taken = 0.0
        self._arrival = 0.0
        self._answered = True
        self._run_begins = False

    def open(self) -> str:
        """Say what is simulated."""
        return f'loopback: rig {self.bench.rig.name}, {"lockstep" if self.virtual else "realtime"}'

    def start(self, now: float) -> None:
        """Begin with sample 0."""
        self._ticker.start(now)

    def begin_run(self) -> None:
        """Let the next sample be the first of a fresh plant with its disturbance."""
        self._run_begins = True

    def due(self) -> float:
        """When the next sample is."""
        if self.virtual:
            return 0.0 if self._answered else float('inf')
        return self._ticker.due()

    def poll(self, now: float) -> list[Reading]:
        """Advance the plant to the present sample."""
        if self.virtual:
            if not self._answered:
                return []
            index, time = self._sequence + 1, (self._sequence + 1) * self.period
            now = time
        else:
            tick = self._ticker.take(now)
            if tick is None:
                return []
            index, time = tick
        while self._sequence < index:
            if self._sequence >= 0:
                self.bench.advance(self._volts, None if self.virtual else self._arrival)
                self._arrival = 0.0
            self._sequence += 1
        self._taken, self._answered = time, False
        if self._run_begins:
            self._run_begins = False
            self.bench.begin()
        return [Reading(index, time, self.bench.volts()[self._inputs], now - time)]

    def write(self, volts: Array, sequence: int, enable: bool, now: float) -> None:
        """Take the voltages; in lockstep the answer of the present sample lets the next one come."""
        del enable
        terminals = np.zeros(self.bench.struts)
        terminals[self._outputs] = volts
        self._volts, self._arrival = terminals, max(now - self._taken, 0.0)
        self._answered = self._answered or sequence == self._sequence

    def zero(self) -> None:
        """Take 0 V."""
        self._volts = np.zeros(self.bench.struts)

    def close(self) -> None:
        """Do nothing: there is nothing to let go of."""


def make(channels: Channels, period: float, lifetime: float) -> Loopback:
    """Build it."""
    return Loopback(channels, period, lifetime, options_of(Options, channels))
