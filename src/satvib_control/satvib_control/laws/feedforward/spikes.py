# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A shock is not learnt from, and the voltage does not follow it.

The weights fit the vibration that lasts, a tone for example. They mean little for a shock, which has a thousand times
its power at other frequencies: 0.1 s after a shock of 20 ms the displacement of the plate alone asks for 20 V. Least
squares fits a shock at once, and the tone is lost. So the reference x is limited,

    |x| <= sqrt(SPIKE <x^2>),

and nothing is learnt from a sample that is limited, or that has

    e^2 > SPIKE <d_hat^2>,

nor from those of the next `HOLD_TIME`, while taps and integrals hold the shock.

Both means take in at most SPIKE times their value. So they follow an amplitude that has grown by the factor 40 within
half a second, and a shock is over before that; a growth by the factor 5 is no shock. e is compared with d_hat, not with
its own mean: after a change of frequency e is far above its mean, and has to be learnt from.

Pulses with silence between them are the vibration itself, and there is nothing to protect from them. So there is no
limit where the power has been below a fifth of its mean over 5 s within the last `SILENCE_TIME`.
"""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.deferred import njit

SPIKE = 25.0  # power over its mean; five standard deviations
SPIKE_TIME = 3.0  # s, of the means
FIRST_TIME = 1.0  # s, a plain mean without a limit
HOLD_TIME = 0.5  # s without learning: the taps and the integrals hold the shock
LONG_TIME, SHORT_TIME = 5.0, 0.3  # s
SHOCK_TIME = (
    0.3  # s from its first sample; once, so that no growth can hide as one shock after another
)
SILENT = 0.2  # short mean over long mean
SILENCE_TIME = 3.0  # s


class _Slot(IntEnum):
    """What is remembered of an item; powers in (m/s^2)^2."""

    USUAL = 0  # mean of x^2 below its limit
    COUNT = 1  # samples of it
    LONG = 2  # <x^2>, LONG_TIME
    SHORT = 3  # <x^2>, SHORT_TIME
    FREE = 4  # s for which there is no limit
    LIMITED = 5  # 1 where this sample of x is limited
    PASSIVE = 6  # mean of d_hat^2 below its limit
    PASSIVES = 7  # samples of it
    LEFT = 8  # samples from which nothing is learnt
    SHOCK = 9  # samples of the shock itself


@njit
def _limit(memory, mean, count, power, settings):
    """Take a power into its mean; give the most that is usual."""
    dt, floor = settings
    memory[count] += 1.0
    if memory[count] * dt < FIRST_TIME:
        memory[mean] += (power - memory[mean]) / memory[count]
        return np.inf
    most = SPIKE * max(memory[mean], floor * floor)
    memory[mean] += (min(power, most) - memory[mean]) * min(dt / SPIKE_TIME, 1.0)
    return most


@njit
def _find_silence(memory, power, settings):
    """Whether there is silence between pulses."""
    dt, floor = settings
    memory[_Slot.LONG] += (power - memory[_Slot.LONG]) * min(dt / LONG_TIME, 1.0)
    memory[_Slot.SHORT] += (power - memory[_Slot.SHORT]) * min(dt / SHORT_TIME, 1.0)
    memory[_Slot.FREE] = max(memory[_Slot.FREE] - dt, 0.0)
    if memory[_Slot.SHORT] < SILENT * memory[_Slot.LONG] and memory[_Slot.LONG] > floor * floor:
        memory[_Slot.FREE] = SILENCE_TIME


@njit
def limit_reference(x, measured, dt, floor, memory):
    """Take a sample of the reference of one item; give it within its limit.

    Args:
        x: m/s^2.
        measured: the sample counts.
        dt: s.
        floor: m/s^2; a smaller RMS counts as this one.
        memory: (m), changed.
    """
    limited = x
    memory[_Slot.LIMITED] = 0.0
    if measured and abs(x) < 1e140:
        free = memory[_Slot.FREE] > 0.0
        _find_silence(memory, x * x, (dt, floor))
        most = np.sqrt(_limit(memory, _Slot.USUAL, _Slot.COUNT, x * x, (dt, floor)))
        if abs(x) > most and not free:
            limited = np.copysign(most, x)
            memory[_Slot.LIMITED] = 1.0
    return limited


@njit
def judge_error(error, passive, measured, dt, floor, hold, memory):
    """Judge a sample of one item; after `limit_reference`.

    Args:
        error: e, m/s^2.
        passive: d_hat, m/s^2.
        measured: the sample counts.
        dt: s.
        floor: m/s^2.
        hold: see `hold_of`.
        memory: (m), changed.

    Returns:
        Nothing is to be learnt; a shock says nothing about the law.
    """
    spike = memory[_Slot.LIMITED] > 0.0
    if measured and abs(error) < 1e140 and abs(passive) < 1e140:
        most = _limit(memory, _Slot.PASSIVE, _Slot.PASSIVES, passive * passive, (dt, floor))
        spike = spike or (error * error > most and memory[_Slot.FREE] == 0.0)
    begins = memory[_Slot.LIMITED] > 0.0 and memory[_Slot.LEFT] == 0.0
    memory[_Slot.SHOCK] = SHOCK_TIME / dt if begins else max(memory[_Slot.SHOCK] - 1.0, 0.0)
    shock = memory[_Slot.SHOCK] > 0.0
    memory[_Slot.LEFT] = hold if spike else max(memory[_Slot.LEFT] - 1.0, 0.0)
    return memory[_Slot.LEFT] > 0.0, shock


def spike_memory(shape: tuple[int, ...]) -> Array:
    """What is remembered of the items (*shape, m), at the start."""
    return np.zeros((*shape, len(_Slot)))


def hold_of(taps: int, dt: float) -> float:
    """Samples without learning after a spike.

    Args:
        taps: samples of the reference that the regressor holds.
        dt: s.
    """
    return float(max(taps, round(HOLD_TIME / dt)))
