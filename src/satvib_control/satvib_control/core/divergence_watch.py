# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The last line of defence: a law whose vibration grows is taken off, asked whether it was the cause, and given less.

Every other guard trusts the identified model. This one asks the plant. With powers over the watch time,

    suspicion:  <y^2> > R^2 base    and    ( <y^2> > 2 <(y - G_hat u)^2>    or    a quarter of the voltages cut )

base is the power that the plant had at 0 V, and y - G_hat u what the model thinks it would be now: a vibration that
grows while the model sees the same growth in the disturbance is no suspicion, unless the voltage stands at its limit.
Without a model any growth at a voltage of more than a twentieth of the limit is suspect.

At a suspicion the voltage fades to 0; one watch time later, when the strut has rung down, its power is measured over
another. If that is less than half, the law was guilty: it is reset and goes on with half its voltage, until somebody
resets the controller; the third time is a fault. If not, the disturbance has grown: its power is the new base, and the
law goes on as before. A hundred watch times in peace forgive one time.
"""

from typing import Any

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel
from satvib_ident.models.iir_model import IirModel

from satvib_control.core.parameters import CoreParameters
from satvib_control.core.trusted_model import TrustedModel

STRIKES = 3.0
# places in the memory
OUTPUT, PASSIVE, EFFORT, RAIL, BASE, BEFORE, CLOCK, SHARE, GUILTY, PEACE = range(10)
SIZE = 10


@kernel(
    'void(f8,f8,f8,f8,f8,f8[:],f8[:],f8[:],f8[:])',
    '(),(),(),(),(),(s),(m)->(),()',
    writable=('memory',),
)
def _watch(
    y: Any,
    passive: Any,
    effort: Any,
    saturated: Any,
    acting: Any,
    settings: Any,
    memory: Any,
    scale: Any,
    verdict: Any,
) -> None:
    """Judge one sample of one item.

    Args:
        y: m/s^2.
        passive: m/s^2; y - G_hat u, NaN without a model.
        effort: share of the voltage limit in use.
        saturated: 0 or 1.
        acting: 1 where the law's voltage is let through in this phase.
        settings: watch time in samples, R, noise floor in m/s^2.
        memory: see the places.
        scale: share of the law's voltage that is let through.
        verdict: 0 nothing, 1 the law was guilty on this sample, 2 it has failed for good.
    """
    window, ratio, floor = settings[0], settings[1], settings[2]
    forget = 1.0 / window
    verdict[0] = 0.0
    before = memory[OUTPUT]
    memory[OUTPUT] += forget * (y * y - before)
    memory[EFFORT] += forget * (effort * effort - memory[EFFORT])
    memory[RAIL] += forget * (saturated - memory[RAIL])
    if np.isnan(passive):
        memory[PASSIVE] = np.nan
    elif np.isnan(memory[PASSIVE]):
        memory[PASSIVE] = memory[OUTPUT]
    else:
        memory[PASSIVE] += forget * (passive * passive - memory[PASSIVE])
    if acting == 0.0:
        memory[BASE] = memory[OUTPUT]
        memory[CLOCK] = 0.0
        scale[0] = memory[SHARE]
        return
    if memory[CLOCK] > 0.0:  # taken off: fade, listen, judge
        memory[CLOCK] += 1.0
        fading = max(0.1 * window, 1.0)
        scale[0] = memory[SHARE] * max(1.0 - memory[CLOCK] / fading, 0.0)
        heard = memory[CLOCK] - fading - window
        if heard > 0.0:  # a plain mean, which forgets all that was before
            memory[OUTPUT] = (y * y + (heard - 1.0) * before) / heard if heard > 1.0 else y * y
        if heard < window:
            return
        memory[CLOCK] = 0.0
        memory[PEACE] = 0.0
        memory[BASE] = memory[OUTPUT]
        memory[RAIL] = 0.0
        if memory[OUTPUT] < 0.5 * memory[BEFORE]:
            memory[GUILTY] += 1.0
            memory[SHARE] *= 0.5
            verdict[0] = 2.0 if memory[GUILTY] >= STRIKES else 1.0
        return
    scale[0] = memory[SHARE]
    memory[PEACE] += 1.0
    if memory[PEACE] >= 100.0 * window:
        memory[PEACE] = 0.0
        memory[GUILTY] = max(memory[GUILTY] - 1.0, 0.0)
    grown = memory[OUTPUT] > ratio * ratio * max(memory[BASE], floor * floor)
    cause = memory[OUTPUT] > 2.0 * memory[PASSIVE]  # not so with NaN
    if np.isnan(memory[PASSIVE]):
        cause = memory[EFFORT] > 0.0025
    if grown and (cause or memory[RAIL] > 0.25):
        memory[BEFORE] = memory[OUTPUT]
        memory[CLOCK] = 1.0


class DivergenceWatch:
    """Watches the vibration under a law; see the module's page.

    Args:
        parameters: of the controller.
        dt: s.
        shape: leading axes.
    """

    def __init__(self, parameters: CoreParameters, dt: float, shape: tuple[int, ...] = ()) -> None:
        self.shape, self.limit = shape, parameters.voltage_limit
        window = max(parameters.watch_time / dt, 2.0)
        self._settings = np.array([window, parameters.watch_ratio, parameters.watch_floor])
        self._memory = np.zeros((*shape, SIZE))
        self._memory[..., SHARE] = 1.0
        self._model = TrustedModel(shape)
        self.busy = False  # some law is taken off or has less than its own voltage

    def set_model(self, model: IirModel, trusted: Mask) -> None:
        """Take the model where it is trusted."""
        self._model.take(model, trusted)

    def step(self, y: Array, applied: Array, saturated: Mask, acting: bool) -> tuple[Array, Array]:
        """Judge a sample.

        Args:
            y: shape, m/s^2, without bias.
            applied: shape, V; in force before this sample.
            saturated: shape, bool; that voltage was cut.
            acting: the law's voltage is let through in this phase.

        Returns:
            (shape) share of the law's voltage to let through; (shape) 0, 1 guilty now, 2 failed.
        """
        passive = np.where(self._model.known, y - self._model.effect(applied), np.nan)
        scale, verdict = _watch(
            y, passive, applied / self.limit, saturated.astype(float), float(acting),
            self._settings, self._memory,
        )  # fmt: skip
        # also on the very sample of a suspicion, where the voltage is still whole: the same in any batch
        self.busy = bool((np.asarray(scale) < 1.0).any() or (self._memory[..., CLOCK] > 0.0).any())
        return np.asarray(scale), np.asarray(verdict)

    def listening(self) -> Mask:
        """Where (shape) the law is taken off at the moment."""
        return np.asarray(self._memory[..., CLOCK] > 0.0)

    def reduced(self) -> Mask:
        """Where (shape) the law has less than its own voltage."""
        return np.asarray(self._memory[..., SHARE] < 1.0)

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget all charges where `mask` holds."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)
        for place, value in ((CLOCK, 0.0), (SHARE, 1.0), (GUILTY, 0.0), (PEACE, 0.0)):
            self._memory[..., place] = np.where(pick, value, self._memory[..., place])
