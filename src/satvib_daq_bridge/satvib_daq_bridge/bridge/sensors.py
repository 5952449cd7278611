# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""From volts to accelerations, and the faults of a sensor.

    acceleration = polarity (volts - zero_voltage) / sensitivity

A reading is *clipped* where the sensor or its converter stands at an end of its range, or nearer to it than a small
share of the range: there the acceleration is at least what the reading says. The range of a sensor is often smaller
than that of its converter: 0.5 to 4.5 V of 0 to 5 V. It is counted from the sensor's own zero, which its measured bias
says. `satvib_plant_sim.physics.converters` has the same rule.

A sensor is at fault when its reading is no number or one that its converter cannot give (beyond the range), when it
stands at an end of the converter's range (railed: a broken wire, no supply), or when it repeats one value for
`stuck_time` (a frozen converter; noise moves a live one). A device that stops sampling gives no reading; the caller
watches that.
"""

from collections.abc import Sequence

import numpy as np
from satvib_common.arrays import Array, Mask

from satvib_daq_bridge.channels import SensorChannel

# of the span: nearer than this to an end of the range counts as railed
_MARGIN = 0.005


class Sensors:
    """All inputs of a bridge, in the order of `Channels.inputs`.

    Args:
        inputs: names and channels.
        rate: Hz, sample rate.
        railed_samples: readings in a row at an end of the range that make a fault.
    """

    def __init__(
        self, inputs: Sequence[tuple[str, SensorChannel]], rate: float, railed_samples: int = 5
    ) -> None:
        self.names = [name for name, _ in inputs]
        channels = [channel for _, channel in inputs]
        self._zero = np.array([c.zero_voltage for c in channels])
        self._scale = np.array([c.polarity / c.sensitivity for c in channels])
        low, high = np.array([c.range for c in channels]).reshape(-1, 2).T
        margin = np.maximum(_MARGIN * (high - low), [c.step for c in channels])
        self._low, self._high = low + margin, high - margin
        self._lowest, self._highest = low - margin, high + margin
        self._range = np.array([c.sensor_range or np.inf for c in channels])
        self._rest = np.array([c.rest for c in channels])
        self._railed_samples = railed_samples
        self._stuck_samples = np.array(
            [max(round(c.stuck_time * rate), 2) if c.stuck_time else np.inf for c in channels]
        )
        self.reset()

    def reset(self) -> None:
        """Forget what was read so far."""
        self._last = np.full(len(self.names), np.nan)
        self._same = np.zeros(len(self.names))
        self._railed = np.zeros(len(self.names))

    def acceleration(self, volts: Array) -> Array:
        """Give m/s^2 (inputs) for V (inputs); NaN for what the converter cannot give."""
        return np.where(self._impossible(volts), np.nan, self._scale * (volts - self._zero))

    def _impossible(self, volts: Array) -> Mask:
        return ~((volts >= self._lowest) & (volts <= self._highest))

    def clipped(self, volts: Array, bias: Array) -> Mask:
        """Give where (inputs) a reading (V) is clipped; `bias` is what each sensor reads at rest, m/s^2."""
        shown = self.acceleration(volts) - (bias - self._rest)
        at_end = np.abs(shown) >= (1.0 - _MARGIN) * self._range
        railed = (volts <= self._low) | (volts >= self._high)
        return np.asarray((at_end | railed) & ~self._impossible(volts))

    def watch(self, volts: Array) -> str:
        """Take one reading (inputs, V); gives the fault, empty without one."""
        same = volts == self._last
        self._same = np.where(same, self._same + 1.0, 1.0)
        outside = (volts <= self._low) | (volts >= self._high)
        self._railed = np.where(outside, self._railed + 1.0, 0.0)
        self._last = volts
        for what, wrong in (
            ('reads no number', ~np.isfinite(volts)),
            ('is beyond what its converter can give,', self._impossible(volts)),
            ('is railed', self._railed >= self._railed_samples),
            ('is stuck', self._same >= self._stuck_samples),
        ):
            if wrong.any():
                which = int(np.argmax(wrong))
                return f'{self.names[which]} {what} at {volts[which]:g} V'
        return ''
