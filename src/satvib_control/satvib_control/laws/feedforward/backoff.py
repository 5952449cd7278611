# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""When feedforward learns, when it acts, and when it backs off.

| state | leaves when | next | voltage | learns |
|---|---|---|---|---|
| LISTEN | one watch time of a loud reference is over | ACT | 0 V | in the last quarter |
| ACT | alarm | FADE | rises within half a watch time | while the reference is loud |
| FADE | a tenth of the watch time is over | RESTART | falls to 0 V | no |
| RESTART | after one sample | RING_DOWN, or GIVEN_UP after the third alarm | 0 V | no, the weights become 0 |
| RING_DOWN | one watch time is over | LISTEN | 0 V | no |
| GIVEN_UP | its time is over, `reset`, or a new model (`forgive`) | LISTEN | 0 V | no, the weights are 0 |

LISTEN measures how much of the reference x passes to the upper acceleration y at 0 V:

    r_0 = <y^2> / <x^2>.

The modified form of `fxlms` needs no voltage to learn, so the first voltage already comes from many samples. After an
alarm r_0 is at most what it was before the first alarm, because other struts may shake the payload meanwhile.

Loud. Nothing is learnt unless the RMS of x is above the floor and <d_hat^2> < 30^2 <x^2> (in LISTEN also <y^2>). A
payload that rings shakes the lower plate too, and then x is too small for what it has to explain.

Alarm. A secondary path that is wrong by more than 90 degrees makes every gradient law climb instead of descend, and no
test with the model alone can see that. It is an alarm when

    <y^2> > R^2 max(r_0, 1) <x^2>   and   <(G_hat u)^2> > <y^2> / 4,

so when the vibration is larger than without control, and the voltage is large enough to be the cause. Here y and u are
averaged over a fifth of the watch time, because a vibration that grows does so quickly. It is also an alarm when the
guard has cut more than a third of the last samples: a loop through a contaminated reference shows itself like that,
because x grows with y.

After n alarms the next one needs less: R^(1 / (n + 1)) and r_0 itself, or four watch times, on balance, in which <y^2>
is not a decibel below r_0 <x^2>. Ten watch times in which it is take one alarm back; no wrong path causes them.

Given up. The cause may pass: a shock, another law, a rig that changes back. So the law tries again after 10 watch
times, then after 20, 40 and so on. Its pace stays that of the last alarm, and the next alarm is the last one again.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

# How much: powers and shares
ALARMS = 3  # alarms until the law gives up: two may have a cause that passes
TRANSMISSION = 30.0  # largest ratio of y to x, as RMS: no passive isolator amplifies as much
GOOD = 0.8  # of r_0 <x^2>, a decibel: the law does some good
CAUSE = 4.0  # <y^2> / <(G_hat u)^2>: a smaller voltage cannot be the cause
CUT_SHARE = 1.0 / 3.0  # of samples cut: a law that works well is seldom at the limit
SLOWER = 0.25  # pace after an alarm, as a ratio to that before
FASTER = 4.0  # the same when an alarm is taken back
# How long: in watch times
HEARD = 0.5  # that are still counted when the reference falls silent
SETTLED = 0.75  # before the first learning: x is there before its filtered twin
RISE = 0.5
FALL = 0.1
USELESS = 4.0  # without any good, until an alarm
FORGIVEN = 10.0  # of good, until an alarm is taken back
RETRY = 10.0  # at 0 V after it has given up for the first time; twice as long each time after that
LONGEST = 6  # doublings
QUICKER = 5.0  # ratio of the watch time to the averaging time of what may be an alarm


class BackoffState(IntEnum):
    """States of an item; see the table of the module."""

    LISTEN = 0
    ACT = 1
    FADE = 2
    RESTART = 3
    RING_DOWN = 4
    GIVEN_UP = 5


class _Slot(IntEnum):
    """What is remembered of an item; powers in (m/s^2)^2, times in samples."""

    ERROR = 0  # <y^2>
    PASSIVE = 1  # <d_hat^2>, d_hat = y - G_hat u
    REFERENCE = 2  # <x^2>
    QUICK = 3  # <y^2> over a shorter time
    EFFECT = 4  # <(G_hat u)^2> over a shorter time
    CUT = 5  # share of samples that the guard cut
    PASSED = 6  # r_0
    PASSED_FIRST = 7  # r_0 before the first alarm; 0: no alarm yet
    HEARD = 8  # samples since LISTEN began
    LEFT = 9  # of FADE or RING_DOWN
    SHARE = 10  # of the voltage that is let through
    GOOD = 11  # samples of good
    USELESS = 12  # samples without any good minus those with
    ALARMS = 13
    PACE = 14  # of the adaptation, 0 to 1
    GIVEN_UP = 15  # how many times it has given up
    FOLLOWING = 16  # state of the next sample


class Judged(NamedTuple):
    """One sample of one item, see `Backoff.step`."""

    error: float
    reference: float
    effect: float
    cut: bool
    valid: bool
    acting: bool


class Settings(NamedTuple):
    """See `Backoff.tune`."""

    window: float
    ratio: float
    floor: float


@njit
def _measure(sample, window, memory):
    """Update all mean values by a sample; plain means at first, later with forgetting."""
    if not sample.valid:
        return
    memory[_Slot.HEARD] += 1.0
    forget = max(1.0 / memory[_Slot.HEARD], 1.0 / window)
    passive = sample.error - sample.effect
    memory[_Slot.ERROR] += forget * (sample.error * sample.error - memory[_Slot.ERROR])
    memory[_Slot.PASSIVE] += forget * (passive * passive - memory[_Slot.PASSIVE])
    memory[_Slot.REFERENCE] += forget * (
        sample.reference * sample.reference - memory[_Slot.REFERENCE]
    )
    quick = max(1.0 / memory[_Slot.HEARD], min(QUICKER / window, 1.0))
    memory[_Slot.QUICK] += quick * (sample.error * sample.error - memory[_Slot.QUICK])
    memory[_Slot.EFFECT] += quick * (sample.effect * sample.effect - memory[_Slot.EFFECT])
    memory[_Slot.CUT] += ((1.0 if sample.cut else 0.0) - memory[_Slot.CUT]) / window


@njit
def _loud(floor, explained, memory):
    """Whether the reference is above the floor, and large enough for the power that it has to explain."""
    enough = memory[_Slot.REFERENCE] * TRANSMISSION * TRANSMISSION >= explained
    return memory[_Slot.REFERENCE] > floor * floor and enough


@njit
def _listen(sample, settings, memory):
    """Measure r_0 at 0 V; give the next state, and whether this sample is worth learning from."""
    window = settings.window
    _measure(sample, window, memory)
    explained = max(memory[_Slot.PASSIVE], memory[_Slot.ERROR])
    if not _loud(settings.floor, explained, memory):
        memory[_Slot.HEARD] = min(memory[_Slot.HEARD], HEARD * window)
        return BackoffState.LISTEN, False
    settled = memory[_Slot.HEARD] >= SETTLED * window
    if memory[_Slot.HEARD] < window or not sample.valid:
        return BackoffState.LISTEN, settled
    memory[_Slot.PASSED] = max(memory[_Slot.ERROR] / memory[_Slot.REFERENCE], 1e-300)
    if memory[_Slot.PASSED_FIRST] > 0.0:
        memory[_Slot.PASSED] = min(memory[_Slot.PASSED], memory[_Slot.PASSED_FIRST])
    return BackoffState.ACT, settled


@njit
def _count_good(settings, memory):
    """Count the samples that do some good and those that do not; take an alarm back after many good ones."""
    good = memory[_Slot.ERROR] < GOOD * memory[_Slot.PASSED] * memory[_Slot.REFERENCE]
    memory[_Slot.GOOD] += 1.0 if good else 0.0
    if memory[_Slot.REFERENCE] > settings.floor * settings.floor:
        memory[_Slot.USELESS] = max(memory[_Slot.USELESS] + (-1.0 if good else 1.0), 0.0)
    if memory[_Slot.GOOD] >= FORGIVEN * settings.window:
        memory[_Slot.GOOD] = 0.0
        memory[_Slot.ALARMS] = max(memory[_Slot.ALARMS] - 1.0, 0.0)
        if memory[_Slot.ALARMS] == 0.0:
            memory[_Slot.PASSED_FIRST] = 0.0
        memory[_Slot.PACE] = min(FASTER * memory[_Slot.PACE], 1.0)


@njit
def _alarm(settings, memory):
    """Whether the voltage does harm, does no good, or stands at the limit."""
    alarms = memory[_Slot.ALARMS]
    growth = settings.ratio ** (2.0 / (alarms + 1.0))
    passed = max(memory[_Slot.PASSED], 1.0) if alarms == 0.0 else memory[_Slot.PASSED]
    grown = memory[_Slot.QUICK] > growth * passed * memory[_Slot.REFERENCE]
    cause = CAUSE * memory[_Slot.EFFECT] > memory[_Slot.QUICK]
    useless = alarms > 0.0 and memory[_Slot.USELESS] > USELESS * settings.window
    harm = (grown and cause) or useless
    loud = memory[_Slot.REFERENCE] > settings.floor * settings.floor
    return (harm and loud) or memory[_Slot.CUT] > CUT_SHARE


@njit
def _act(sample, settings, memory):
    """Let the voltage in and watch what it does; give the next state, and whether the reference is loud."""
    window = settings.window
    _measure(sample, window, memory)
    loud = _loud(settings.floor, memory[_Slot.PASSIVE], memory)
    if not sample.acting:
        memory[_Slot.SHARE] = 0.0
        return BackoffState.ACT, loud
    memory[_Slot.SHARE] = min(memory[_Slot.SHARE] + 1.0 / max(RISE * window, 1.0), 1.0)
    if not sample.valid:
        return BackoffState.ACT, loud
    _count_good(settings, memory)
    if not _alarm(settings, memory):
        return BackoffState.ACT, loud
    memory[_Slot.ALARMS] += 1.0
    memory[_Slot.PACE] *= SLOWER
    memory[_Slot.LEFT] = max(FALL * window, 1.0)
    return BackoffState.FADE, loud


@njit
def _fade(window, memory):
    """Let the voltage fall; at the end forget all but what the alarms have changed."""
    memory[_Slot.LEFT] -= 1.0
    memory[_Slot.SHARE] = max(memory[_Slot.SHARE] - 1.0 / max(FALL * window, 1.0), 0.0)
    if memory[_Slot.LEFT] > 0.0:
        return BackoffState.FADE
    first, passed = memory[_Slot.PASSED_FIRST], memory[_Slot.PASSED]
    alarms, pace = memory[_Slot.ALARMS], memory[_Slot.PACE]
    given_up = memory[_Slot.GIVEN_UP]
    memory[:] = 0.0
    memory[_Slot.GIVEN_UP] = given_up
    memory[_Slot.PASSED_FIRST] = passed if first == 0.0 else first
    memory[_Slot.ALARMS], memory[_Slot.PACE] = alarms, pace
    memory[_Slot.LEFT] = window
    return BackoffState.RESTART


@njit
def _ring_down(sample, memory):
    """Wait until the strut has rung down: what rings is no measure of what passes."""
    if sample.valid:
        memory[_Slot.LEFT] -= 1.0
    return BackoffState.RING_DOWN if memory[_Slot.LEFT] > 0.0 else BackoffState.LISTEN


@njit
def _restart(window, memory):
    """After FADE: ring down, or wait longer where there were too many alarms."""
    if memory[_Slot.ALARMS] < ALARMS:
        return BackoffState.RING_DOWN
    memory[_Slot.LEFT] = RETRY * window * 2.0 ** min(memory[_Slot.GIVEN_UP], LONGEST)
    memory[_Slot.GIVEN_UP] += 1.0
    memory[_Slot.ALARMS] = ALARMS - 1.0
    return BackoffState.GIVEN_UP


@njit
def _wait(memory):
    """GIVEN_UP: 0 V until it is time to try again."""
    memory[_Slot.LEFT] -= 1.0
    return BackoffState.GIVEN_UP if memory[_Slot.LEFT] > 0.0 else BackoffState.LISTEN


@njit
def judge(sample, settings, memory):
    """Judge one sample of one item; see `Backoff.step`: gives its state, and whether the reference is loud."""
    states, loud = np.empty(2, np.int64), False
    now, following = states[:1], states[1:]
    now[0] = int(memory[_Slot.FOLLOWING])
    if now[0] == BackoffState.RESTART:
        now[0] = _restart(settings.window, memory)
    following[0] = now[0]
    if now[0] == BackoffState.LISTEN:
        following[0], loud = _listen(sample, settings, memory)
    elif now[0] == BackoffState.ACT:
        following[0], loud = _act(sample, settings, memory)
    elif now[0] == BackoffState.FADE:
        following[0] = _fade(settings.window, memory)
    elif now[0] == BackoffState.RING_DOWN:
        following[0] = _ring_down(sample, memory)
    elif now[0] == BackoffState.GIVEN_UP:
        following[0] = _wait(memory)
    memory[_Slot.FOLLOWING] = following[0]
    # FADE and RESTART begin on the very sample that causes them
    if following[0] == BackoffState.FADE or following[0] == BackoffState.RESTART:
        now[0] = following[0]
    return now[0], loud


@njit
def share_of(memory):
    """Share of the voltage that is let through."""
    return memory[_Slot.SHARE]


@njit
def pace_of(memory):
    """Pace of the adaptation."""
    return memory[_Slot.PACE]


@kernel(
    'void(f8, f8, f8, b1, b1, b1, f8[:], f8[:], i8[:], b1[:])',
    '(),(),(),(),(),(),(n),(m)->(),()',
    writable=('memory',),
)
def _step(error, reference, effect, cut, valid, acting, settings, memory, now, loud):
    """Judge one sample of one item; see `Backoff.step`."""
    sample = Judged(error, reference, effect, cut, valid, acting)
    now[0], loud[0] = judge(sample, Settings(settings[0], settings[1], settings[2]), memory)


class Backoff:
    """The back-off of a batch of items; see the module.

    Args:
        shape: leading axes.

    Attributes:
        memory: (*shape, m) what is remembered of the items.
        settings: (3) `Settings`.
    """

    def __init__(self, shape: tuple[int, ...] = ()) -> None:
        self.shape = shape
        self.memory = np.zeros((*shape, len(_Slot)))
        self.reset(np.ones(shape, dtype=bool))

    def tune(self, window: int, ratio: float, floor: float) -> None:
        """Set the watch time (samples), the growth R that is an alarm, and the least RMS of the reference (m/s^2)."""
        self.settings = np.array(Settings(window, ratio, floor))

    def step(
        self, error: Array, reference: Array, effect: Array, cut: Mask, valid: Mask, acting: bool
    ) -> tuple[Integers, Mask]:
        """Judge a sample.

        Args:
            error: shape, y, m/s^2.
            reference: shape, x, m/s^2.
            effect: shape, G_hat u of the voltage of this law, m/s^2.
            cut: shape, bool; the guard cut that voltage.
            valid: shape, bool; all was measured, and only the law and the disturbance act.
            acting: the voltage of the law is let through in this phase.

        Returns:
            (shape) `BackoffState` of this sample; (shape) bool, the reference is worth learning from.
        """
        now, loud = _step(error, reference, effect, cut, valid, acting, self.settings, self.memory)
        return np.asarray(now), np.asarray(loud)

    @property
    def share(self) -> Array:
        """Share of the voltage that is let through (shape)."""
        return self.memory[..., _Slot.SHARE]

    @property
    def pace(self) -> Array:
        """Pace of the adaptation (shape), 1 before the first alarm."""
        return self.memory[..., _Slot.PACE]

    @property
    def alarms(self) -> Array:
        """Alarms that are not taken back (shape)."""
        return self.memory[..., _Slot.ALARMS]

    @property
    def passed(self) -> Array:
        """r_0 (shape); 0 while it is not known."""
        return self.memory[..., _Slot.PASSED]

    def forgive(self, mask: Mask) -> None:
        """Begin again where `mask` (shape) holds and there were alarms, as a new model deserves."""
        self.reset(mask & (self.alarms > 0.0))

    def reset(self, mask: Mask) -> None:
        """Begin again where `mask` (shape) holds."""
        self.memory[...] = np.where(mask[..., None], 0.0, self.memory)
        self.pace[...] = np.where(mask, 1.0, self.pace)
