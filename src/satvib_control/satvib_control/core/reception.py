# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a controller receives: a sample without bias, what the coils got before it, and a start in the middle of a run.

A source of samples says with each sample what the coil got instead of the answer to the sample before. Where that was
0 V, the law has no effect: nothing is learnt, its share goes to 0 and rises again when the voltage is applied again.

A controller that is started when CALIBRATE is over knows no bias. It stays at 0 V until the strut's identifier gives
the biases, and for `LISTEN_TIME` in any case, for the level of the vibration at 0 V. Without an identifier the means of
that time are the biases.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.phases import Phase, PhasePlan
from satvib_common.signals.calibration import BiasCalibration
from satvib_common.signals.readings import possible
from satvib_common.struts.applied import CHANGED, TEXTS, WITHHELD, Applied

from satvib_control.laws.reasons import reason

LISTEN_TIME = 0.25  # s
PATIENCE = 0.4  # s, for the biases of an identifier
JOINED = reason('0 V: started in the middle of a run, listening to the sensors')
_USUAL = {int(Applied.APPLIED)}
_SAYING = {int(state) for state in Applied} - {int(Applied.UNKNOWN)}
_LARGEST = 1e4  # V
# by state
_REASONS = np.array([reason(TEXTS[state]) for state in Applied])


class Measured(NamedTuple):
    """A sample of the sensors without their biases.

    Attributes:
        upper: shape, m/s^2; 0 where it was not measured.
        lower: shape, m/s^2; NaN where it was not measured.
        valid: shape, bool; the upper acceleration was measured.
        upper_clipped, lower_clipped: shape, bool; the sensor stands at an end of its range.
        whole: it was measured everywhere: such a sample takes the short ways.
    """

    upper: Array
    lower: Array
    valid: Mask
    upper_clipped: Mask
    lower_clipped: Mask
    whole: bool


class Wish(NamedTuple):
    """What is asked of the guard: V (shape), and what the output shows of it; see `ControllerOutput`."""

    demand: Array
    reference: Array
    adapting: Mask
    reason: Integers


@dataclass(frozen=True)
class Received:
    """What the coils got before a sample; all None: what was asked for.

    Attributes:
        voltage: shape, V.
        changed: shape, bool; it is not what was asked for.
        withheld: shape, bool; it is 0 V instead.
        reason: shape, codes of why; 0 where it is what was asked for.
    """

    voltage: Array | None = None
    changed: Mask | None = None
    withheld: Mask | None = None
    reason: Integers | None = None


def readings_of(samples: Sequence[Any], shape: tuple[int, ...]) -> Sequence[Any]:
    """Give upper and lower acceleration (m/s^2; NaN: not measured), and which of them are clipped, each of `shape`.

    Args:
        samples: as satvib_msgs/StrutAcceleration; a reading that no sensor gives counts as not measured.
        shape: of the controller.
    """
    found = [
        (possible(s.upper), possible(s.lower), s.upper_clipped, s.lower_clipped) for s in samples
    ]
    return list(zip(*found, strict=True)) if shape else found[0]


def received_of(samples: Sequence[Any], shape: tuple[int, ...]) -> Received | None:
    """Give what the samples of the struts say of the voltages before them; None where the source says nothing.

    Args:
        samples: with `applied`, V, and `applied_state`, an `Applied`, as satvib_msgs/StrutAcceleration.
        shape: of the controller.
    """
    states = {sample.applied_state for sample in samples}
    # a state that there is not, or a voltage that no amplifier gives, says nothing
    if not states <= _SAYING or not all(abs(s.applied) <= _LARGEST for s in samples):
        return None
    voltage: Array = np.array([sample.applied for sample in samples]).reshape(shape)
    if states == _USUAL:
        return Received(voltage)
    state = np.array([sample.applied_state for sample in samples]).reshape(shape)
    return Received(
        voltage, np.asarray(state >= CHANGED), np.asarray(state >= WITHHELD), _REASONS[state]
    )


class LateStart:
    """The listening of a controller that joins a run.

    Args:
        dt: s.
        shape: leading axes.

    Attributes:
        on: it listens at 0 V.
    """

    def __init__(self, dt: float, shape: tuple[int, ...]) -> None:
        self._dt, self._shape = dt, shape
        self.on = False
        self._given: tuple[ArrayLike, ArrayLike] | None = None
        self._heard = 0

    def begin(self, k: int, plan: PhasePlan, calibrated: bool) -> None:
        """Take the first sample of a plan: whether CALIBRATE was missed."""
        start = plan.first_of(Phase.CALIBRATE)
        over = start is not None and start < k and plan.at(k) is not Phase.CALIBRATE
        self.on = over and not calibrated
        self._heard = 0

    def give(self, upper: ArrayLike, lower: ArrayLike) -> None:
        """Take the biases (shape, m/s^2) from elsewhere; NaN: not known."""
        self._given = upper, lower

    def listen(
        self, upper: Array, lower: Array, upper_bias: BiasCalibration, lower_bias: BiasCalibration
    ) -> None:
        """Take a sample (shape, m/s^2, as measured); at the end the biases are known.

        Args:
            upper, lower: NaN: not measured.
            upper_bias, lower_bias: are changed.
        """
        upper_bias.add(upper)
        lower_bias.add(lower)
        self._heard += 1
        if self._given is not None:
            for bias, given in zip((upper_bias, lower_bias), self._given, strict=True):
                bias.mean = np.where(np.isfinite(given), given, bias.mean)
        wanted = LISTEN_TIME if self._given is not None else PATIENCE
        self.on = self._heard * self._dt < wanted
