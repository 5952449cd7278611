# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The supervisor: hears all struts, and finds the one that makes the others loud.

A strut's own watch hears its own sensor. It misses what a sensor hides that is stuck or has lost gain: the law shakes
the payload, the other struts are loud and pause, and their pauses do not help. The supervisor listens to the
accelerations and voltages of all struts. So it knows the power of each when *all* of them were at 0 V last, and who
pauses.

| state | leaves when | next | what it asks |
|---|---|---|---|
| WATCHING | a strut is loud for `PATIENCE`, and some voltage acts | TRYING | hold a strut |
| TRYING | the loud strut has fallen by half | WATCHING | release all but the last: that is the cause, a strike |
| TRYING | it has not fallen | TRYING | hold the next one too |
| TRYING | it has not fallen, and all are held | WATCHING | release all: the disturbance has grown |

The order: the strut with most strikes, then the one that has acted longest without a pause, then the loudest. A strike
holds for `TURN`. The third one is a stop, latched in the strut's controller until its reset. After a try in which
the disturbance had grown the power at 0 V is new, and the patience is doubled.

Nothing here uses a model, and no strut needs the supervisor: without it each strut has its own watch. A hold ends by
itself in the controller, so a supervisor that ends holds nobody for long.

It decides at the last sample of every period of `CHECK_TIME`; what it asks holds from the next sample on. In lockstep
the controllers wait there for its judgement, so live and offline runs are equal bit for bit.
"""

from typing import TYPE_CHECKING

import numpy as np
from satvib_common.arrays import Array, Integers
from satvib_common.phases import Phase, PhasePlan
from satvib_common.signals.calibration import BiasCalibration

from satvib_control.supervision.parameters import SupervisorParameters
from satvib_control.supervision.supervisor_step import Ask, fresh_supervisor, strikes_of, supervise

if TYPE_CHECKING:
    from satvib_control.core.controller import ControllerCore

CHECK_TIME = 0.1  # s
LOUDNESS = 4.0  # dB; what the struts' own watches allow is no measure here, they may be off

__all__ = ['Ask', 'SupervisorCore', 'ask', 'check_period', 'is_checked']


def check_period(rate: float) -> int:
    """Samples between two decisions of the supervisor; `rate` in Hz."""
    return max(round(CHECK_TIME * rate), 1)


def is_checked(k: int, rate: float) -> bool:
    """Whether what the supervisor asks holds from sample k on."""
    return k > 0 and k % check_period(rate) == 0


def ask(controller: 'ControllerCore', asks: Integers) -> None:
    """Do what the supervisor asks (shape, `Ask`) to a controller; a node calls services for the same."""
    if not asks.any():
        return
    controller.hold(asks == Ask.HOLD)
    controller.release(asks == Ask.RELEASE)
    controller.stop(asks == Ask.STOP)


class SupervisorCore:
    """Watches all struts of an isolator, or of a batch of them.

    Args:
        parameters: of the controllers; their rate, voltage limit and the floor of their watches.
        shape: leading axes; the last one counts the struts.
    """

    def __init__(self, parameters: SupervisorParameters, shape: tuple[int, ...]) -> None:
        p = parameters
        self.shape, self.rate, self.limit = shape, p.sample_rate, p.voltage_limit
        self._dt = 1.0 / p.sample_rate
        self._settings = np.array([self._dt, p.watch_floor, 10.0 ** (0.1 * LOUDNESS)])
        self._bias = BiasCalibration(shape)
        self._struts, self._common = fresh_supervisor(shape)

    def step(self, k: int, plan: PhasePlan, upper: Array, voltage: Array) -> Integers:
        """Take sample k of all struts.

        Args:
            k: sequence of the sample.
            plan: the phases.
            upper: shape, m/s^2, as measured; NaN: not measured.
            voltage: shape, V, that answers the sample; NaN: nothing is known of it.

        Returns:
            (shape) `Ask`, to hold from sample k + 1 on.
        """
        phase = plan.at(k)
        if phase == Phase.CALIBRATE:
            self._bias.add(upper)
        y = upper - self._bias.mean
        decides = is_checked(k + 1, self.rate)
        asks = supervise(
            np.where(np.isfinite(y), y, 0.0),
            np.where(np.isfinite(voltage), voltage, 0.0) / self.limit,
            float(phase == Phase.CONTROL), float(decides), self._settings,
            self._struts, self._common,
        )  # fmt: skip
        return np.asarray(asks).astype(np.int64)

    @property
    def strikes(self) -> Array:
        """Strikes of each strut (shape)."""
        return strikes_of(self._struts)
