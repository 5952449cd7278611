# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""When law narrowband has to be at 0 V: it tests on the strut whether its voltage does harm, or no good.

A model whose phase at the tone is wrong by 80 degrees or more makes the voltage feed what it is to cancel. The model
itself explains the growth as one of the disturbance, so no test that uses the model alone can see it. Therefore the
vibration is compared with its own power at 0 V, the base. The base is learnt only while the law's voltage is 0.

| state | leaves when | next | voltage | learns |
|---|---|---|---|---|
| QUIET | the law gives a voltage | ACTING | 0 V | after four paces the base |
| ACTING | suspicion | HELD | the law's | powers; `model_correction` the error of the model |
| HELD | of a proven law, four paces at 0 V are louder than it was | ACTING | 0 V | the power is the new base |
| HELD | the hold is over and the power fell by half | ACTING | 0 V | the law is the cause: it comes back slower |
| HELD | the hold is over, the power did not fall | EXTENDED | 0 V | nothing: the cause may be another strut |
| EXTENDED | two first holds are over | as HELD, or ACTING | 0 V | the least power is the new base |

There is suspicion when the vibration is

    loud       y^2 > 2 base for five paces; less time when it is louder,
    quick      y^2 > 4 base, and the effect of the voltage in the model is large enough to be the cause,
    useless    y^2 > 0.7 base for 20 paces on balance,
    lost       the tracker is lost, and the attempt shows clearly that the model is turned.

A hold lasts ten paces at least. When the law was the cause, the next hold is four times as long. The law then comes
back twice as slow, fades in four times as slowly, and 1.4 base is enough for the next suspicion. After `useless` and
`lost` the law is always taken for the cause. In EXTENDED the law listens because the growth may come from another
strut, which is about to be held as well. For the same reason the new base is the least power of a hold, not the last.
Means are over a pace, in a hold over four paces. Success (y^2 below a tenth of the base) shortens the next hold by an
e-fold in 100 paces. A law that acts before it has listened takes the power that it finds for its base until the first
hold, which is then not extended.

A law is proven once it has brought y^2 below a tenth of the base, until it is found to be the cause. When the vibration
of a proven law grows, and grows further at 0 V, its voltage was still of use: the disturbance has grown. The law goes
on after those four paces, or two where it grows by half, with the tones that it had.

Where the attempt was loud or lost and has shown the error of the model (`model_correction`), the next hold is as long
as the first. The law then comes back four times as slow as at first: struts that correct their models at the same time
disturb each other less so.
"""

import math
from enum import IntEnum

from satvib_common.kernels.deferred import njit

from satvib_control.laws.narrowband.memory import Backoff, Setting, Tracking

RING_DOWN = (
    4.0  # paces at 0 V before anything is learnt of the strut: its own vibration has decayed
)
GROWN = 2.0  # times the base is loud; beats of two tones stay below
GROWN_AFTER_HARM = 1.4  # the same for a law that has done harm
PATIENCE = 5.0  # paces of loudness up to a hold; and the most that one sample counts
QUICK = 4.0  # times the base is suspect at once
CAUSE = 0.25  # least power of the voltage's effect that can be the cause of y^2
NO_CAUSE = 1.0 / 16.0  # share of y^2 below which the effect of the voltage cannot be the cause
NO_USE = 0.7  # of the base: less is use
USELESS_AFTER = 20.0  # paces
SUCCESS = 0.1  # of the base
CAUSED = 0.5  # the power in the hold over that before it, below which the law was the cause
LONGER = 4.0  # factor on the next hold after harm
BRIEFLY = 2.0  # paces at 0 V of a proven law, after which a vibration is judged that grows further
MUCH_LOUDER = 1.5  # times the power before the hold: the same
LONGEST_HOLD = 600.0  # first holds
SLOWEST = 8.0  # largest factor on the paces after harm
SLOW_AFTER_CORRECTION = 4.0  # factor on the paces with a corrected model


class Verdict(IntEnum):
    """What a sample means for the voltage."""

    FREE = 0  # no hold
    TAKEN_OFF = 1  # a hold begins
    HELD = 2
    CAUSED = 3  # a hold has ended; the law was the cause, and the attempt may show the error of the model


@njit
def watch(backoff, tracking, settings, y, effect, act, turned):
    """Take a sample; give the verdict.

    Args:
        backoff, tracking: changed.
        settings: of the law.
        y: m/s^2.
        effect: m/s^2; of the voltage on y, by the model.
        act: the law's voltage is let through in this phase.
        turned: the tracker was lost in an attempt that shows that the model is turned (`model_correction`).
    """
    _measure(backoff, settings[Setting.PACE], y, effect)
    _learn_from_level(backoff, settings)
    if backoff[Backoff.HOLD] > 0.0:
        return _hold(backoff, tracking, settings)
    if not act or backoff[Backoff.VOLTS] == 0.0:
        return _quiet(backoff)
    return _acting(backoff, settings, turned)


@njit
def restart(backoff, settings):
    """After the model was corrected: the next hold is as the first, and the law comes back slowly."""
    backoff[Backoff.NEXT_HOLD] = settings[Setting.FIRST_HOLD]
    backoff[Backoff.SLOW] = max(backoff[Backoff.SLOW], SLOW_AFTER_CORRECTION)


@njit
def rung_down(backoff, pace):
    """Whether the voltage has been 0 long enough to learn from the strut."""
    return backoff[Backoff.SILENT] > RING_DOWN * pace


@njit
def _quiet(backoff):
    """QUIET: a voltage that is not there is no suspect."""
    backoff[Backoff.LOUD], backoff[Backoff.USELESS] = 0.0, 0.0
    return Verdict.FREE


@njit
def _acting(backoff, settings, turned):
    """ACTING: suspect or not."""
    if backoff[Backoff.BASE] == 0.0:
        backoff[Backoff.BASE] = backoff[Backoff.LEVEL]
    loud = _loud(backoff, settings[Setting.PACE])
    useless = _useless(backoff, settings[Setting.PACE])
    if not (loud or useless or turned):
        return Verdict.FREE
    backoff[Backoff.BEFORE] = backoff[Backoff.LEVEL] if loud else math.inf
    backoff[Backoff.INSTRUCTIVE] = 1.0 if loud or turned else 0.0
    backoff[Backoff.LEAST] = math.inf
    backoff[Backoff.BRIEF] = backoff[Backoff.PROVEN] if loud and not turned else 0.0
    backoff[Backoff.LOUD], backoff[Backoff.USELESS] = 0.0, 0.0
    backoff[Backoff.EXTENDED] = 0.0 if backoff[Backoff.BASE_KNOWN] > 0.0 else 1.0
    backoff[Backoff.HOLD] = max(backoff[Backoff.NEXT_HOLD], settings[Setting.FIRST_HOLD])
    return Verdict.TAKEN_OFF


@njit
def _hold(backoff, tracking, settings):
    """HELD and EXTENDED: wait, then judge by the power at 0 V."""
    first_hold = settings[Setting.FIRST_HOLD]
    backoff[Backoff.HOLD] -= 1.0
    louder = backoff[Backoff.LEVEL] > backoff[Backoff.BEFORE]
    louder = louder and rung_down(backoff, settings[Setting.PACE])
    much = backoff[Backoff.LEVEL] > MUCH_LOUDER * backoff[Backoff.BEFORE]
    much = much and backoff[Backoff.SILENT] > BRIEFLY * settings[Setting.PACE]
    if backoff[Backoff.BRIEF] > 0.0 and (louder or much):
        backoff[Backoff.HOLD], backoff[Backoff.BRIEF] = 0.0, 0.0
        backoff[Backoff.BASE], backoff[Backoff.BASE_KNOWN] = backoff[Backoff.LEVEL], 1.0
        return Verdict.FREE
    if backoff[Backoff.HOLD] > 0.0:
        return Verdict.HELD
    backoff[Backoff.BASE_KNOWN] = 1.0
    if backoff[Backoff.LEAST] < CAUSED * backoff[Backoff.BEFORE]:
        _slow_down(backoff, tracking, first_hold)
        return Verdict.CAUSED if backoff[Backoff.INSTRUCTIVE] > 0.0 else Verdict.FREE
    if backoff[Backoff.EXTENDED] == 0.0:
        backoff[Backoff.EXTENDED] = 1.0
        backoff[Backoff.HOLD] = 2.0 * first_hold
        return Verdict.HELD
    backoff[Backoff.BASE] = backoff[Backoff.LEAST]
    return Verdict.FREE


@njit
def _slow_down(backoff, tracking, first_hold):
    """The law was the cause: a longer hold the next time, and slower paces."""
    longer = LONGER * max(backoff[Backoff.NEXT_HOLD], first_hold)
    backoff[Backoff.NEXT_HOLD] = min(longer, LONGEST_HOLD * first_hold)
    backoff[Backoff.SLOW] = min(2.0 * backoff[Backoff.SLOW], SLOWEST)
    tracking[Tracking.STRETCH] = max(tracking[Tracking.STRETCH], backoff[Backoff.SLOW])
    backoff[Backoff.BASE] = min(backoff[Backoff.LEAST], backoff[Backoff.BASE])
    backoff[Backoff.PROVEN] = 0.0


@njit
def _measure(backoff, pace, y, effect):
    """Take a sample into the powers."""
    backoff[Backoff.HEARD] += 1.0
    share = max(1.0 / pace, 1.0 / backoff[Backoff.HEARD])
    backoff[Backoff.LEVEL] += (y * y - backoff[Backoff.LEVEL]) * share
    backoff[Backoff.QUICK_LEVEL] += (y * y - backoff[Backoff.QUICK_LEVEL]) * 2.0 / pace
    old = backoff[Backoff.QUICK_EFFECT]
    backoff[Backoff.QUICK_EFFECT] += (effect * effect - old) * 2.0 / pace
    backoff[Backoff.PASSIVE_PEAK] *= 1.0 - 0.1 / pace
    if backoff[Backoff.QUICK_EFFECT] < backoff[Backoff.QUICK_LEVEL] * NO_CAUSE:
        peak = max(backoff[Backoff.PASSIVE_PEAK], backoff[Backoff.QUICK_LEVEL])
        backoff[Backoff.PASSIVE_PEAK] = peak


@njit
def _learn_from_level(backoff, settings):
    """At 0 V learn the base, or the least power of a hold; in success shorten the next hold."""
    pace, level = settings[Setting.PACE], backoff[Backoff.LEVEL]
    acting = backoff[Backoff.VOLTS] != 0.0
    if not rung_down(backoff, pace):
        backoff[Backoff.RESTING_LEVEL] = level
    backoff[Backoff.SILENT] = 0.0 if acting else backoff[Backoff.SILENT] + 1.0
    if rung_down(backoff, pace) and backoff[Backoff.HOLD] > 0.0:
        resting = backoff[Backoff.RESTING_LEVEL]
        resting += (level - resting) / (4.0 * pace)
        backoff[Backoff.RESTING_LEVEL] = resting
        backoff[Backoff.LEAST] = min(backoff[Backoff.LEAST], resting)
    elif rung_down(backoff, pace):
        backoff[Backoff.BASE] += (level - backoff[Backoff.BASE]) / pace
        backoff[Backoff.BASE_KNOWN] = 1.0
    elif acting and level < SUCCESS * backoff[Backoff.BASE]:
        shorter = backoff[Backoff.NEXT_HOLD] * (1.0 - 0.01 / pace)
        backoff[Backoff.NEXT_HOLD] = max(shorter, settings[Setting.FIRST_HOLD])
        backoff[Backoff.PROVEN] = 1.0
        backoff[Backoff.SLOW] = max(backoff[Backoff.SLOW] * (1.0 - 0.05 / pace), 1.0)


@njit
def _loud(backoff, pace):
    """Whether the vibration has been loud for too long, or grows quickly."""
    base = backoff[Backoff.BASE]
    grown = GROWN if backoff[Backoff.SLOW] == 1.0 else GROWN_AFTER_HARM
    growth = backoff[Backoff.LEVEL] / (grown * base + 1e-300)
    if growth > 1.0:
        backoff[Backoff.LOUD] += min(growth, PATIENCE)
    else:
        backoff[Backoff.LOUD] = max(backoff[Backoff.LOUD] - 0.5, 0.0)
    level = backoff[Backoff.QUICK_LEVEL]
    quick = level > QUICK * max(base, backoff[Backoff.PASSIVE_PEAK])
    quick = quick and backoff[Backoff.QUICK_EFFECT] > CAUSE * level
    return quick or backoff[Backoff.LOUD] > PATIENCE * pace


@njit
def _useless(backoff, pace):
    """Whether the voltage has been without use for too long."""
    useless = backoff[Backoff.LEVEL] > NO_USE * backoff[Backoff.BASE]
    if useless and backoff[Backoff.FADED] > 0.5:
        backoff[Backoff.USELESS] += 1.0
    else:
        backoff[Backoff.USELESS] = max(backoff[Backoff.USELESS] - 4.0, 0.0)
    limit = USELESS_AFTER * pace * max(0.5 * backoff[Backoff.SLOW], 1.0)
    return backoff[Backoff.USELESS] > limit
