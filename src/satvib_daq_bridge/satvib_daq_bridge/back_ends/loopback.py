# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back end `loopback`: a simulated plant in the guardian's own process, for trials without hardware.

With `pace: lockstep` sample k + 1 comes when sample k has been answered: no clock, the same bits every time. With
`pace: realtime` it comes when its time has come, and the arrival of the voltages is measured.

The device is any one name. Input i is the upper sensor of strut i, input n + i its lower sensor, output i its coil.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.schema import Schema, param
from satvib_plant_sim.rig.rig import load_rig

from satvib_daq_bridge.back_ends.base import (
    Reading,
    check_indices,
    options_of,
    single_device,
)
from satvib_daq_bridge.back_ends.pace.paced import PACES, Paced
from satvib_daq_bridge.channels import Channels
from satvib_daq_bridge.simulated.bench import Bench


@dataclass(frozen=True, kw_only=True)
class Options(Schema):
    """Settings of the loopback."""

    rig: str = param('paper_3dof', 'name of a rig, or the path of its file')
    rig_overrides: dict[str, Any] = param(dict, 'changes to the rig by dotted key')
    disturbance: dict[str, Any] = param(dict, 'what shakes the rig once a run begins')
    seed: int = param(1, 'seed of everything random', minimum=0)
    pace: str = param('realtime', 'who keeps the time', choices=PACES)


class Loopback(Paced):
    """The plant as a device."""

    def __init__(
        self, channels: Channels, period: float, lifetime: float, options: Options
    ) -> None:
        super().__init__(channels, period, lifetime, options.pace)
        single_device(channels)
        rig = load_rig(options.rig, options.rig_overrides)
        self.bench = Bench(rig, options.disturbance, options.seed)
        self.bench.check_rate(1.0 / period)
        check_indices(channels.where, channels.inputs, 2 * self.bench.struts, 'input')
        check_indices(channels.where, channels.outputs, self.bench.struts, 'output')
        self._inputs = np.array([c.index for _, c in channels.inputs])
        self._outputs = np.array([c.index for _, c in channels.outputs])
        self._volts = np.zeros(self.bench.struts)
        self._taken = 0.0
        self._arrival = 0.0

    def open(self) -> str:
        """Give the line about what is simulated."""
        return f'loopback: rig {self.bench.rig.name}, {"lockstep" if self.virtual else "realtime"}'

    def poll(self, now: float) -> list[Reading]:
        """Advance the plant to the present sample."""
        due = self.next_sample(now)
        if due is None:
            return []
        index, time, late = due
        while self._sequence < index:
            if self._sequence >= 0:
                self.bench.advance(self._volts, None if self.virtual else self._arrival)
                self._arrival = 0.0
            self._sequence += 1
        self._taken, self._answered = time, False
        if self._run_begins:
            self._run_begins = False
            self.bench.begin()
        return [Reading(index, time, self.bench.volts()[self._inputs], late)]

    def write(self, volts: Array, sequence: int, enable: bool, now: float) -> None:
        """Take the voltages; in lockstep the answer of the present sample lets the next one come."""
        del enable
        terminals = np.zeros(self.bench.struts)
        terminals[self._outputs] = volts
        self._volts, self._arrival = terminals, max(now - self._taken, 0.0)
        self.answer(sequence)

    def zero(self) -> None:
        """Take 0 V."""
        self._volts = np.zeros(self.bench.struts)


def make(channels: Channels, period: float, lifetime: float) -> Loopback:
    """Build it."""
    return Loopback(channels, period, lifetime, options_of(Options, channels))
