# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back ends whose devices have no clock: the host keeps the time, reads every input and writes every output."""

import contextlib
import time
from abc import abstractmethod
from collections.abc import Callable

import numpy as np
from satvib_common.arrays import Array

from satvib_daq_bridge.back_ends.base import BackEnd, BackEndError, Reading
from satvib_daq_bridge.back_ends.pace.ticker import Ticker
from satvib_daq_bridge.channels import Channels


class Polled(BackEnd):
    """Devices that are read and written by the host.

    Attributes:
        writers: functions made by `open`. Each takes the voltages of all outputs (outputs, V), sets its own, and raises
            `BackEndError` when its device fails.
    """

    def __init__(self, channels: Channels, period: float, lifetime: float) -> None:
        super().__init__(channels, period, lifetime)
        self.writers: list[Callable[[Array], None]] = []
        self._ticker = Ticker(period)

    @abstractmethod
    def read(self) -> Array:
        """Give all inputs as they are now (inputs, V).

        Raises:
            BackEndError: a device fails or is gone.
        """

    def start(self, now: float) -> None:
        """Start the clock."""
        self._ticker.start(now)

    def due(self) -> float:
        """The next tick."""
        return self._ticker.due()

    def poll(self, now: float) -> list[Reading]:
        """Read all inputs when it is time."""
        tick = self._ticker.take(now)
        if tick is None:
            return []
        index, when = tick
        volts = self.read()
        return [Reading(index, when, volts, max(time.monotonic() - when, 0.0))]

    def write(self, volts: Array, sequence: int, enable: bool, now: float) -> None:
        """Write all outputs; one that fails does not keep the others from being written."""
        del sequence, enable, now
        failed: BackEndError | None = None
        for put in self.writers:
            try:
                put(volts)
            except BackEndError as error:
                failed = failed or error
        if failed is not None:
            raise failed

    def zero(self) -> None:
        """Write 0 V to every output that was found."""
        volts = np.zeros(len(self.channels.outputs))
        for put in self.writers:
            with contextlib.suppress(BackEndError):
                put(volts)

    def figures(self) -> dict[str, float]:
        """Ticks that were missed."""
        return {'samples lost': float(self._ticker.lost)}
