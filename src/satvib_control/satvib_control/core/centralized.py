# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The controller of all struts at once: `ControllerCore`, whose struts share one law and stop together.

Phases, calibration, excitation and the guard of each voltage are those of a single strut's controller. What makes one
strut stop (a sensor lost for good, a law that has diverged, no rest in CALIBRATE) stops all of them: there is one law.
Its gains were tuned before the run; models that are identified during it change nothing here.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Integers, Mask
from satvib_ident.models.iir_model import IirModel

from satvib_control.core.clipping_watch import ClippingWatch
from satvib_control.core.controller import ControllerCore
from satvib_control.core.vibration_memory import Peek, Slot
from satvib_control.core.vibration_watch import VibrationWatch
from satvib_control.laws.centralized.parameters import CentralizedParameters
from satvib_control.parameters import ControllerParameters


class CentralizedCore(ControllerCore):
    """Centralized controller of one isolator, or of a batch of them.

    Args:
        parameters: see `CentralizedParameters`.
        shape: leading axes, the last of which counts the struts.

    Raises:
        SatvibError: a shape whose last axis is not that of all struts.
    """

    def __init__(self, parameters: CentralizedParameters, shape: tuple[int, ...] = (3,)) -> None:
        super().__init__(parameters, shape)

    def _begin(self) -> None:
        super()._begin()
        self.watch = _CommonWatch(self.parameters, self.dt, self.shape)
        limit = self.parameters.clipping_limit
        self.clipping = ClippingWatch(limit, self.dt, self.shape, together=True)

    def set_model(
        self,
        model: IirModel,
        trusted: ArrayLike = True,
        why: Any = '',
        covariance: Array | None = None,
    ) -> None:
        """Nothing: a model of single struts is not what this law was tuned on."""

    def _causes(self, valid: Mask, verdict: Integers, blind: Mask) -> Integers:
        return _worst(super()._causes(valid, verdict, blind))


class _CommonWatch(VibrationWatch):
    """Takes the law off all struts when one of them is loud; all come back together."""

    in_turn = False

    def step(self, y: Array, applied: Array, acting: bool, silent: bool) -> tuple[Array, Integers]:
        # no short look: all voltages are off for the longest pause of any strut, so a shorter one saves nothing, and
        # 0.15 s give a worse base than a whole pause
        self._memory[..., Slot.PEEK] = Peek.NO
        scale, verdict = super().step(y, applied, acting, silent)
        least = np.broadcast_to(np.min(scale, axis=-1, keepdims=True), self.shape)
        return least, _worst(verdict)

    def listening(self) -> Mask:
        return np.asarray(_worst(super().listening()), dtype=bool)

    def reduced(self) -> Mask:
        return np.asarray(_worst(super().reduced()), dtype=bool)


def _worst(values: Any) -> Any:
    """The largest over the struts, for each of them."""
    return np.broadcast_to(np.max(values, axis=-1, keepdims=True), np.shape(values))


def make_core(parameters: ControllerParameters, shape: tuple[int, ...] = ()) -> ControllerCore:
    """Give the core that fits the parameters: centralized, or one for each strut."""
    if isinstance(parameters, CentralizedParameters):
        return CentralizedCore(parameters, shape)
    return ControllerCore(parameters, shape)
