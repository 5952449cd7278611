# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Bias of the sensors at rest: measured once at 0 V, checked, and then kept.

The paper's accelerations are "compensated by initial bias error". A bias is refused when the sensor was not at rest
(standard deviation above `noise_limit`) or when the offset from where it should rest is more than `zero_tolerance`:
both mean a wrong channel, a wrong sensor or a rig that moves, which no correction can remove.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import yaml
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.signals.calibration import BiasCalibration

from satvib_daq_bridge.channels import SensorChannel

# s, the shortest measurement of a bias
SHORTEST = 1.0


class SensorBias:
    """The bias of all inputs, in the order of `Channels.inputs`.

    Args:
        inputs: names and channels.
        rate: Hz, sample rate.
        duration: s, at least `SHORTEST`.

    Raises:
        SatvibError: a duration that is too short.

    Attributes:
        value: (inputs) m/s^2; 0 until it is measured.
        deviation: (inputs) m/s^2, standard deviation during the measurement; NaN until then.
        learnt: whether the value is valid.
    """

    def __init__(
        self, inputs: Sequence[tuple[str, SensorChannel]], rate: float, duration: float = SHORTEST
    ) -> None:
        if not duration >= SHORTEST:
            raise SatvibError(f'calibration_time: {duration} s is less than {SHORTEST} s')
        self._inputs = tuple(inputs)
        self._wanted = int(np.ceil(duration * rate - 1e-9))
        self._running = BiasCalibration((len(inputs),))
        self._count = 0
        self.value: Array = np.zeros(len(inputs))
        self.deviation: Array = np.full(len(inputs), np.nan)
        self.learnt = False

    def restart(self) -> None:
        """Start the measurement again; the old bias is no longer valid."""
        self._running.reset()
        self._count = 0
        self.learnt = False

    def add(self, acceleration: Array) -> bool:
        """Take one sample (inputs, m/s^2) at rest; gives whether the measurement has ended with it.

        Raises:
            SatvibError: a bias that is not plausible; the measurement starts again.
        """
        self._running.add(acceleration)
        self._count += 1
        if self._count < self._wanted:
            return False
        mean, deviation = self._running.mean.copy(), self._running.standard_deviation
        count = self._running.count
        self.restart()
        for i, (name, channel) in enumerate(self._inputs):
            _check(name, channel, float(mean[i]), float(deviation[i]), int(count[i]), self._wanted)
        self.value, self.deviation, self.learnt = mean, deviation, True
        return True

    def correct(self, acceleration: Array) -> Array:
        """Give the acceleration (inputs, m/s^2) without the bias."""
        return acceleration - self.value

    def to_mapping(self) -> dict[str, dict[str, float]]:
        """Give bias and deviation of each channel by name, m/s^2."""
        return {
            name: {'bias': float(b), 'standard_deviation': float(d)}
            for (name, _), b, d in zip(self._inputs, self.value, self.deviation, strict=True)
        }


def _check(
    name: str, channel: SensorChannel, mean: float, deviation: float, count: int, wanted: int
) -> None:
    if count < wanted:
        raise SatvibError(
            f'{name}: {wanted - count} of {wanted} calibration samples are no numbers'
        )
    if not deviation <= channel.noise_limit:
        raise SatvibError(
            f'{name}: standard deviation {deviation:.3g} m/s^2 at rest is above noise_limit '
            f'{channel.noise_limit:g}; is the rig at rest, and the sensor wired?'
        )
    offset = abs(mean - channel.rest) * channel.sensitivity
    if not offset <= channel.zero_tolerance:
        raise SatvibError(
            f'{name}: rests {offset:.3g} V from where it should, above zero_tolerance '
            f'{channel.zero_tolerance:g} V; check zero_voltage, rest and the wiring'
        )


def save_bias(path: Path, values: Mapping[str, Mapping[str, float]]) -> None:
    """Write the bias to a file; a file that exists is replaced.

    Raises:
        SatvibError: it cannot be written.
    """
    try:
        text = yaml.safe_dump({k: dict(v) for k, v in values.items()}, sort_keys=False)
        path.write_text(text, encoding='utf-8')
    except OSError as error:
        raise SatvibError(f'{path}: the calibration cannot be written: {error.strerror}') from None
