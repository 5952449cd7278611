# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The last line of defence: a law whose vibration grows is taken off; if it was the cause it comes back with less.

Every other guard trusts the identified model. This one tests on the plant.

| state | leaves when | next | voltage | learns |
|---|---|---|---|---|
| RESTING | CONTROL begins | ACTING | none, or the law's in ADAPT | base: the power before CONTROL |
| ACTING | suspicion | FADING | the law's, times its share | the law |
| FADING | a tenth of the watch time is over | RINGING_DOWN | falls to 0 V | nothing |
| RINGING_DOWN | one watch time is over | LISTENING | 0 V | nothing |
| LISTENING | one watch time is over | ACTING | 0 V | the power at 0 V, which is the new base |

There is suspicion when, with powers over the watch time,

    <y^2> > R^2 base    and    ( <y^2> > 2 <(y - G_hat u)^2>    or    a quarter of the voltages cut ).

y - G_hat u is what the vibration would be without the voltage, by the model. When the model sees the same growth in the
disturbance there is no suspicion, unless the voltage stands at its limit. Without a model any growth at a voltage of
more than a twentieth of the limit is suspect.

At the end of LISTENING the law was the cause when the power at 0 V is less than half of the power at the suspicion. The
law is then reset and goes on with half its share, until the controller is reset; the third time is a fault. Otherwise
the disturbance has grown, and the law goes on as before. A hundred watch times without suspicion take one time back.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba import njit
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.kernels.compile import kernel
from satvib_ident.models.iir_model import IirModel

from satvib_control.core.parameters import CoreParameters
from satvib_control.core.trusted_model import TrustedModel

TIMES = 3.0  # that the law was the cause until a fault: two may have a cause that passes
CAUSE = 2.0  # <y^2> over <(y - G_hat u)^2>: less growth is explained by the disturbance
EFFORT = 0.0025  # (1 / 20)^2 of the limit: without a model, less voltage cannot be the cause
CUT = 0.25  # share of voltages cut: the law is at its limit
FALLEN = 0.5  # power at 0 V over that at the suspicion, below which the law was the cause
LESS = 0.5  # factor on the law's share
FADE = 0.1  # watch times
FORGIVEN = 100.0  # watch times without suspicion that take one time back


class WatchState(IntEnum):
    """States of an item; see the table of the module."""

    RESTING = 0
    ACTING = 1
    FADING = 2
    RINGING_DOWN = 3
    LISTENING = 4


class WatchVerdict(IntEnum):
    """What a sample has shown about the law."""

    NONE = 0  # nothing
    CAUSED = 1  # the law was the cause: reset it
    DIVERGED = 2  # for the third time: a fault


class _Slot(IntEnum):
    """Places in the memory of an item."""

    POWER = 0  # (m/s^2)^2; <y^2>
    PASSIVE = 1  # (m/s^2)^2; <(y - G_hat u)^2>; NaN without a model
    EFFORT = 2  # mean square of the voltage over its limit
    CUT = 3  # share of voltages cut
    BASE = 4  # (m/s^2)^2; <y^2> at 0 V
    BEFORE = 5  # (m/s^2)^2; <y^2> at the suspicion
    CLOCK = 6  # samples since the suspicion, from 1; 0: not taken off
    SHARE = 7  # of the law's voltage that is let through
    TIMES = 8  # that the law was the cause
    CALM = 9  # samples without suspicion


class _Sample(NamedTuple):
    """One sample of an item: y and y - G_hat u in m/s^2, voltage over its limit, 1 where it was cut."""

    y: float
    passive: float
    effort: float
    cut: float


class _Settings(NamedTuple):
    """Watch time in samples, R, noise floor in m/s^2."""

    window: float
    ratio: float
    floor: float


@njit
def _fading(window):
    """Samples of FADING."""
    return max(FADE * window, 1.0)


@njit
def _state(acting, window, memory):
    """Give the state in which an item takes this sample."""
    if acting == 0.0:
        return WatchState.RESTING
    clock = memory[_Slot.CLOCK]
    if clock == 0.0:
        return WatchState.ACTING
    if clock + 1.0 < _fading(window):
        return WatchState.FADING
    if clock + 1.0 - _fading(window) - window > 0.0:
        return WatchState.LISTENING
    return WatchState.RINGING_DOWN


@njit
def _measure(sample, window, memory):
    """Take a sample into the powers."""
    forget = 1.0 / window
    memory[_Slot.POWER] += forget * (sample.y * sample.y - memory[_Slot.POWER])
    memory[_Slot.EFFORT] += forget * (sample.effort * sample.effort - memory[_Slot.EFFORT])
    memory[_Slot.CUT] += forget * (sample.cut - memory[_Slot.CUT])
    passive = sample.passive
    if np.isnan(passive):
        memory[_Slot.PASSIVE] = np.nan
    elif np.isnan(memory[_Slot.PASSIVE]):
        memory[_Slot.PASSIVE] = memory[_Slot.POWER]
    else:
        memory[_Slot.PASSIVE] += forget * (passive * passive - memory[_Slot.PASSIVE])


@njit
def _suspicious(s, memory):
    """ACTING: whether the vibration has grown and the law may be the cause."""
    memory[_Slot.CALM] += 1.0
    if memory[_Slot.CALM] >= FORGIVEN * s.window:
        memory[_Slot.CALM] = 0.0
        memory[_Slot.TIMES] = max(memory[_Slot.TIMES] - 1.0, 0.0)
    power = memory[_Slot.POWER]
    grown = power > s.ratio * s.ratio * max(memory[_Slot.BASE], s.floor * s.floor)
    cause = power > CAUSE * memory[_Slot.PASSIVE]  # not so with NaN
    if np.isnan(memory[_Slot.PASSIVE]):
        cause = memory[_Slot.EFFORT] > EFFORT
    return grown and (cause or memory[_Slot.CUT] > CUT)


@njit
def _listen(y, before, window, memory):
    """LISTENING: take a plain mean, which forgets all that was before; whether it is over."""
    heard = memory[_Slot.CLOCK] - _fading(window) - window
    memory[_Slot.POWER] = (y * y + (heard - 1.0) * before) / heard if heard > 1.0 else y * y
    return heard >= window


@njit
def _judge(memory):
    """The end of LISTENING: back to ACTING with a new base; give the verdict."""
    memory[_Slot.CLOCK] = 0.0
    memory[_Slot.CALM] = 0.0
    memory[_Slot.BASE] = memory[_Slot.POWER]
    memory[_Slot.CUT] = 0.0
    if memory[_Slot.POWER] >= FALLEN * memory[_Slot.BEFORE]:
        return WatchVerdict.NONE
    memory[_Slot.TIMES] += 1.0
    memory[_Slot.SHARE] *= LESS
    return WatchVerdict.DIVERGED if memory[_Slot.TIMES] >= TIMES else WatchVerdict.CAUSED


@kernel(
    'void(f8,f8,f8,f8,f8,f8[:],f8[:],f8[:],i8[:])',
    '(),(),(),(),(),(s),(m)->(),()',
    writable=('memory',),
)
def _watch(y, passive, effort, cut, acting, settings, memory, scale, verdict):
    """Judge one sample of one item.

    Args:
        y, passive, effort, cut: see `_Sample`.
        acting: 1 where the vibration is watched in this phase.
        settings: see `_Settings`.
        memory: see `_Slot`; changed.
        scale: out, share of the law's voltage that is let through.
        verdict: out, `WatchVerdict`.
    """
    sample = _Sample(y, passive, effort, cut)
    s = _Settings(settings[0], settings[1], settings[2])
    before = memory[_Slot.POWER]
    _measure(sample, s.window, memory)
    verdict[0] = WatchVerdict.NONE
    scale[0] = memory[_Slot.SHARE]
    state = _state(acting, s.window, memory)
    if state == WatchState.RESTING:
        memory[_Slot.BASE] = memory[_Slot.POWER]
        memory[_Slot.CLOCK] = 0.0
    elif state == WatchState.ACTING:
        if _suspicious(s, memory):
            memory[_Slot.BEFORE] = memory[_Slot.POWER]
            memory[_Slot.CLOCK] = 1.0
    else:
        memory[_Slot.CLOCK] += 1.0
        scale[0] *= max(1.0 - memory[_Slot.CLOCK] / _fading(s.window), 0.0)
        if state == WatchState.LISTENING and _listen(y, before, s.window, memory):
            verdict[0] = _judge(memory)


class DivergenceWatch:
    """Watches the vibration under a law; see the module's page.

    Args:
        parameters: of the controller.
        dt: s.
        shape: leading axes.

    Attributes:
        busy: some law is taken off or has less than its own voltage.
    """

    def __init__(self, parameters: CoreParameters, dt: float, shape: tuple[int, ...] = ()) -> None:
        self.shape, self.limit = shape, parameters.voltage_limit
        window = max(parameters.watch_time / dt, 2.0)
        self._settings = np.array(
            _Settings(window=window, ratio=parameters.watch_ratio, floor=parameters.watch_floor)
        )
        self._memory = np.zeros((*shape, len(_Slot)))
        self._memory[..., _Slot.SHARE] = 1.0
        self._model = TrustedModel(shape)
        self.busy = False

    def set_model(self, model: IirModel, trusted: Mask) -> None:
        """Take the model where it is trusted."""
        self._model.take(model, trusted)

    def step(
        self, y: Array, applied: Array, saturated: Mask, acting: bool
    ) -> tuple[Array, Integers]:
        """Judge a sample.

        Args:
            y: shape, m/s^2, without bias.
            applied: shape, V; in force before this sample.
            saturated: shape, bool; that voltage was cut.
            acting: the vibration is watched in this phase.

        Returns:
            (shape) share of the law's voltage to let through; (shape) `WatchVerdict`.
        """
        passive = np.where(self._model.known, y - self._model.effect(applied), np.nan)
        scale, verdict = _watch(
            y, passive, applied / self.limit, saturated.astype(float), float(acting),
            self._settings, self._memory,
        )  # fmt: skip
        # also on the very sample of a suspicion, where the voltage is still whole: the same in any batch
        self.busy = bool((np.asarray(scale) < 1.0).any() or self.listening().any())
        return np.asarray(scale), np.asarray(verdict)

    def listening(self) -> Mask:
        """Where (shape) the law is taken off at the moment."""
        return np.asarray(self._memory[..., _Slot.CLOCK] > 0.0)

    def reduced(self) -> Mask:
        """Where (shape) the law has less than its own voltage."""
        return np.asarray(self._memory[..., _Slot.SHARE] < 1.0)

    def reset(self, mask: Mask | bool = True) -> None:
        """Give the law its whole voltage again where `mask` holds; the powers stay."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)
        start = ((_Slot.CLOCK, 0.0), (_Slot.SHARE, 1.0), (_Slot.TIMES, 0.0), (_Slot.CALM, 0.0))
        for slot, value in start:
            self._memory[..., slot] = np.where(pick, value, self._memory[..., slot])
