# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample of the supervisor, for the struts of one isolator; the states are explained in `supervisor`."""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

LEVEL_TIME = 0.5  # s
QUICK_TIME = 0.06  # s
ACTS = 1e-3  # of the voltage limit; less is no cause
SILENCE = 0.6  # s at 0 V of all struts before the power is the open loop's: fade and ringing
HEARD = 0.25  # s of that power
BASE_TIME = 1.5  # s
REST = 0.3  # s at 0 V that count as a pause of a strut
PATIENCE = 2.0  # s; twice that of a strut's own watch, which comes first
SETTLE = 0.5  # s from a hold until the power is measured: fade and ringing
BLOCK = 0.2  # s of that power
FELL = 0.5  # of the power before
TURN = 2.0  # s, how long a strike is held
STRIKES = 3
FORGIVE = 60.0  # s
LONGEST_PATIENCE = 60.0  # s


class Ask(IntEnum):
    """What is asked of a strut's controller."""

    NOTHING = 0
    HOLD = 1
    RELEASE = 2
    STOP = 3


class Slot(IntEnum):
    """Memory of a strut; powers in (m/s^2)^2, times in s."""

    LEVEL = 0
    QUICK = 1
    BASE = 2  # when all struts were at 0 V last
    LISTENED = 3  # the same, of the present silence
    ACTIVE = 4  # since its last pause
    RESTING = 5  # at 0 V
    LOUD = 6
    HELD = 7  # 1 while it is held in a try
    LEFT = 8  # of a strike's hold
    STRIKES = 9
    STOPPED = 10
    ASK = 11  # an `Ask` that waits for the next check


class Common(IntEnum):
    """Memory of an isolator."""

    TRYING = 0
    CLOCK = 1  # s since the last hold of a try
    SILENT = 2  # s
    LOUDEST = 3  # number of the strut that is listened to in a try
    BEFORE = 4  # its power before
    LAST = 5  # number of the strut that was held last
    BLOCK = 6  # energy
    PATIENCE = 7  # s
    PEACE = 8  # s without a try


@njit
def _measure(struts, common, y, effort, dt):
    """Take a sample of all struts into powers and clocks."""
    silent = True
    for i in range(y.shape[0]):
        m, power = struts[i], y[i] * y[i]
        m[Slot.LEVEL] += (power - m[Slot.LEVEL]) * min(dt / LEVEL_TIME, 1.0)
        m[Slot.QUICK] += (power - m[Slot.QUICK]) * min(dt / QUICK_TIME, 1.0)
        if abs(effort[i]) > ACTS:
            silent = False
            m[Slot.RESTING] = 0.0
        else:
            m[Slot.RESTING] += dt
        m[Slot.ACTIVE] = 0.0 if m[Slot.RESTING] > REST else m[Slot.ACTIVE] + dt
    common[Common.SILENT] = common[Common.SILENT] + dt if silent else 0.0
    heard = common[Common.SILENT] - SILENCE
    if heard <= 0.0:
        return
    for i in range(y.shape[0]):
        m = struts[i]
        m[Slot.LISTENED] += (y[i] * y[i] - m[Slot.LISTENED]) * min(dt / min(heard, BASE_TIME), 1.0)
        if heard > HEARD:
            m[Slot.BASE] = m[Slot.LISTENED]


@njit
def _limit(m, settings):
    """The power above which a strut is loud."""
    return settings[2] * max(m[Slot.BASE], settings[1] * settings[1])


@njit
def _before(one, other):
    """Whether a strut is held before another one: by strikes, then by the time without a pause, then by its level."""
    if one[Slot.STRIKES] != other[Slot.STRIKES]:
        return one[Slot.STRIKES] > other[Slot.STRIKES]
    if abs(one[Slot.ACTIVE] - other[Slot.ACTIVE]) > REST:
        return one[Slot.ACTIVE] > other[Slot.ACTIVE]
    return one[Slot.LEVEL] > other[Slot.LEVEL]


@njit
def _candidate(struts):
    """The strut to hold next; -1 for none that acts."""
    found = -1
    for i in range(struts.shape[0]):
        m = struts[i]
        free = m[Slot.HELD] == 0.0 and m[Slot.LEFT] == 0.0 and m[Slot.STOPPED] == 0.0
        if free and m[Slot.ACTIVE] > REST and (found < 0 or _before(m, struts[found])):
            found = i
    return found


@njit
def _hold(struts, common, i):
    """Hold a strut, and listen from now on."""
    struts[i, Slot.HELD] = 1.0
    struts[i, Slot.ASK] = Ask.HOLD.value
    common[Common.LAST] = i
    common[Common.CLOCK] = 0.0
    common[Common.BLOCK] = 0.0


@njit
def _watch(struts, common, settings):
    """WATCHING: count how long each strut is loud; begin a try."""
    dt, loudest = settings[0], -1
    common[Common.PEACE] += dt
    for i in range(struts.shape[0]):
        m = struts[i]
        limit = _limit(m, settings)
        if m[Slot.LEVEL] > limit and m[Slot.QUICK] > limit:
            decays = m[Slot.QUICK] < 0.5 * m[Slot.LEVEL]
            m[Slot.LOUD] += 0.0 if decays else dt
        else:
            m[Slot.LOUD] = max(m[Slot.LOUD] - dt, 0.0)
        loud = m[Slot.LOUD] > max(common[Common.PATIENCE], PATIENCE)
        if loud and (loudest < 0 or m[Slot.LOUD] > struts[loudest, Slot.LOUD]):
            loudest = i
    if common[Common.PEACE] > FORGIVE:
        common[Common.PEACE] = 0.0
        common[Common.PATIENCE] = PATIENCE
        for i in range(struts.shape[0]):
            struts[i, Slot.STRIKES] = max(struts[i, Slot.STRIKES] - 1.0, 0.0)
    return loudest


@njit
def _end(struts, common):
    """End a try."""
    common[Common.TRYING] = 0.0
    common[Common.PEACE] = 0.0
    for i in range(struts.shape[0]):
        struts[i, Slot.LOUD] = 0.0
        if struts[i, Slot.HELD] > 0.0:
            struts[i, Slot.HELD] = 0.0
            struts[i, Slot.ASK] = Ask.RELEASE.value


@njit
def _strike(struts, common):
    """The strut that was held last is the cause."""
    cause = int(common[Common.LAST])
    _end(struts, common)
    m = struts[cause]
    m[Slot.STRIKES] += 1.0
    m[Slot.LEFT] = TURN
    m[Slot.ASK] = Ask.NOTHING.value  # it stays held
    if m[Slot.STRIKES] >= STRIKES:
        m[Slot.STOPPED] = 1.0
        m[Slot.LEFT] = 0.0
        m[Slot.ASK] = Ask.STOP.value


@njit
def _try(struts, common, y, dt):
    """TRYING: what the loud strut does without the one that was held last."""
    common[Common.CLOCK] += dt
    loud = int(common[Common.LOUDEST])
    if common[Common.CLOCK] <= SETTLE:
        return False
    common[Common.BLOCK] += y[loud] * y[loud] * dt
    if common[Common.CLOCK] < SETTLE + BLOCK:
        return False
    fell = common[Common.BLOCK] < FELL * common[Common.BEFORE] * (common[Common.CLOCK] - SETTLE)
    if fell:
        _strike(struts, common)
        return False
    return True


@njit
def _decide(struts, common, loudest, failed):
    """At a check: the next hold, or the end of a try in which nothing helped."""
    if not failed and loudest < 0:
        return
    following = _candidate(struts)
    if failed and following < 0:
        power = common[Common.BLOCK] / (common[Common.CLOCK] - SETTLE)
        for i in range(struts.shape[0]):
            struts[i, Slot.BASE] = struts[i, Slot.LEVEL]
        struts[int(common[Common.LOUDEST]), Slot.BASE] = power
        common[Common.PATIENCE] = min(
            2.0 * max(common[Common.PATIENCE], PATIENCE), LONGEST_PATIENCE
        )
        _end(struts, common)
    elif following >= 0:
        if not failed:
            common[Common.TRYING] = 1.0
            common[Common.LOUDEST] = loudest
            common[Common.BEFORE] = struts[loudest, Slot.LEVEL]
        _hold(struts, common, following)


@kernel(
    'void(f8[:], f8[:], f8, f8, f8[:], f8[:,:], f8[:], f8[:])',
    '(n),(n),(),(),(s),(n,m),(q)->(n)',
    writable=('struts', 'common'),
)
def supervise(y, effort, acting, decides, settings, struts, common, asks):
    """Take a sample of all struts; give the `Ask` of each at a check."""
    dt = settings[0]
    asks[:] = 0.0
    _measure(struts, common, y, effort, dt)
    if acting <= 0.0:
        return
    loudest, failed = -1, False
    if common[Common.TRYING] > 0.0:
        failed = _try(struts, common, y, dt)
    else:
        loudest = _watch(struts, common, settings)
    for i in range(y.shape[0]):
        m = struts[i]
        if m[Slot.LEFT] > 0.0:
            m[Slot.LEFT] -= dt
            if m[Slot.LEFT] <= 0.0:
                m[Slot.LEFT] = 0.0
                m[Slot.ASK] = Ask.RELEASE.value
    if decides <= 0.0:
        return
    _decide(struts, common, loudest, failed)
    for i in range(y.shape[0]):
        asks[i] = struts[i, Slot.ASK]
        struts[i, Slot.ASK] = Ask.NOTHING.value


def fresh_supervisor(shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Give the memories of struts (*shape, 12) and isolators (*shape[:-1], 9) before the first sample."""
    return np.zeros((*shape, len(Slot))), np.zeros((*shape[:-1], len(Common)))


def strikes_of(struts: Array) -> Array:
    """Strikes (shape)."""
    return np.asarray(struts[..., Slot.STRIKES])
