# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample of the vibration watch, for one strut; the states are explained in `vibration_watch`."""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

LEVEL_TIME, QUICK_TIME = 0.5, 0.06  # s; two periods of the lowest tone that matters
PAST_TIME, BASE_TIME = 1.0, 1.5  # s
MOST = 4.0  # a level of 10 dB counts four times
PATIENCE = 1.0  # s
PATIENCE_RETURNING = 1.0  # s; a quarter of that where it is 10 dB too loud
FADE_TIME, RETURN_TIME = 0.1, 0.3  # s
RING_TIME = 0.3  # s before the first block is compared
BLOCK_TIME, LONGEST_PAUSE = 0.25, 3.0  # s
FALLING = 0.7  # of the block before
PEEK_TIME = 0.15  # s at 0 V, after which a law that calms is known by the rise
RISEN = 1.26  # of the power before
STEADY = 2.0  # most by which the level may be above its mean of a second before such a rise counts
CALMED = 0.8  # of the power at 0 V, half a second after the law is back
TURN = 2.0  # s
ALLOWED_TIME = 5.0  # s; no strut is loud for longer, so what is still heard then is the disturbance
STRIKES = 3
FORGIVE_TIME = 60.0  # s
FALL_TIME, RISE_TIME = 1.0, 30.0  # s; the usual level follows down quickly and up slowly
SETTLE_TIME = 1.0  # s of ACTING before the usual level is learnt
# 4 dB more than loud above the usual level under control: the base may be of another time
UNUSUAL = 2.5
WELL_BELOW = 0.1  # 10 dB below the base nothing is unusual: an open loop rarely falls by more
PATIENCE_UNUSUAL = 1.5  # s; doubles with each pause that shows the law was not the cause
EFFORT = 1e-7  # (0.03 % of the limit)^2: at 0 V the law is not the cause


class State(IntEnum):
    """What the watch does; see the module's table."""

    LISTENING = 0
    ACTING = 1
    PAUSING = 2
    WAITING = 3
    RETURNING = 4


class Peek(IntEnum):
    """Whether a short pause may be enough."""

    NO = 0
    POSSIBLE = 1
    TO_CONFIRM = 2


class Verdict(IntEnum):
    """What a sample brings."""

    NONE = 0
    STRIKE = 1
    FAILED = 2


class Slot(IntEnum):
    """Memory of one strut; powers in (m/s^2)^2, times in s."""

    STATE = 0
    CLOCK = 1  # since the state began
    LEVEL = 2  # power, LEVEL_TIME
    QUICK = 3  # power, QUICK_TIME
    BASE = 4  # power at 0 V
    HEARD = 5  # how long the base has been listened to
    EFFORT = 6  # power of the applied voltage as a share of its limit
    LOUD = 7  # how long it has been loud
    BEFORE = 8  # power when the pause began
    BLOCK = 9  # energy of the present block
    BLOCK_TIME = 10  # its length
    LAST_BLOCK = 11  # power of the block before
    STRUCK = 12  # 1 where the pause follows a strike, which it must not repeat
    QUIET = 13  # how long it has been quiet while waiting
    SHARE = 14  # of the law's voltage
    STRIKES = 15
    PAUSES = 16  # in which the power fell, since the last peace
    PEACE = 17  # s without a pause
    SLOW = 18  # usual power under control
    ACTED = 19  # s since the law came back
    STRANGE = 20  # how long the level has been unusual
    PATIENCE = 21  # for that
    PAST = 22  # power, PAST_TIME
    PEEK = 23  # a `Peek`
    BASE_BEFORE = 24  # power at 0 V before a peek


class Setting(IntEnum):
    """What the watch is told."""

    DT = 0
    FLOOR = 1  # m/s^2
    ORDER = 2  # turns that this strut waits
    RATIO = 3  # of powers, above which it is loud


@njit
def _measure(memory, settings, y, effort):
    """Take a sample into the powers."""
    dt = settings[Setting.DT]
    power = y * y
    memory[Slot.LEVEL] += (power - memory[Slot.LEVEL]) * min(dt / LEVEL_TIME, 1.0)
    memory[Slot.QUICK] += (power - memory[Slot.QUICK]) * min(dt / QUICK_TIME, 1.0)
    memory[Slot.PAST] += (memory[Slot.LEVEL] - memory[Slot.PAST]) * min(dt / PAST_TIME, 1.0)
    memory[Slot.EFFORT] += (effort * effort - memory[Slot.EFFORT]) * min(dt / LEVEL_TIME, 1.0)


@njit
def _limit(power, settings):
    """The power above which a strut is loud whose level at 0 V has `power`; nothing below the floor counts."""
    floor = settings[Setting.FLOOR]
    return settings[Setting.RATIO] * max(power, floor * floor)


@njit
def _loud(memory, settings):
    """How many times the limit the level is; 0 where it decays, and -1 where it is below the limit."""
    limit = _limit(memory[Slot.BASE], settings)
    if memory[Slot.LEVEL] <= limit or memory[Slot.QUICK] <= limit:
        return -1.0
    if memory[Slot.QUICK] < 0.5 * memory[Slot.LEVEL]:
        return 0.0
    return min(memory[Slot.LEVEL] / limit, MOST)


@njit
def _go(memory, state):
    """Begin a state."""
    memory[Slot.STATE] = state.value
    memory[Slot.CLOCK] = memory[Slot.LOUD] = memory[Slot.QUIET] = 0.0


@njit
def _listen(memory, settings, y, silent):
    """LISTENING: learn the base where nobody excites on purpose."""
    if not silent:
        memory[Slot.HEARD] = 0.0
        return
    memory[Slot.HEARD] += settings[Setting.DT]
    forget = settings[Setting.DT] / min(memory[Slot.HEARD], BASE_TIME)
    memory[Slot.BASE] += (y * y - memory[Slot.BASE]) * forget


@njit
def _is_loud_for(memory, settings, patience):
    """Count how long it has been loud."""
    change = _loud(memory, settings) * settings[Setting.DT]
    memory[Slot.LOUD] = max(memory[Slot.LOUD] + change, 0.0)
    return memory[Slot.LOUD] > patience


@njit
def _pause(memory):
    """Begin a pause."""
    memory[Slot.BEFORE] = memory[Slot.LEVEL]
    memory[Slot.BLOCK] = memory[Slot.BLOCK_TIME] = 0.0
    memory[Slot.LAST_BLOCK] = np.inf
    memory[Slot.STRUCK] = memory[Slot.PEACE] = 0.0
    memory[Slot.ACTED] = memory[Slot.STRANGE] = 0.0
    memory[Slot.PEEK] = Peek.NO.value
    _go(memory, State.PAUSING)


@njit
def _strike(memory):
    """The law of this strut is the cause."""
    memory[Slot.STRIKES] += 1.0
    memory[Slot.SHARE] *= 0.5
    memory[Slot.PAUSES] = 0.0
    return Verdict.FAILED if memory[Slot.STRIKES] >= STRIKES else Verdict.STRIKE


@njit
def _act(memory, settings):
    """ACTING: the law's voltage, until it has been loud for too long."""
    memory[Slot.PEACE] += settings[Setting.DT]
    if memory[Slot.PEACE] > FORGIVE_TIME:
        memory[Slot.PEACE] = memory[Slot.PAUSES] = 0.0
        memory[Slot.STRIKES] = max(memory[Slot.STRIKES] - 1.0, 0.0)
    loud = _is_loud_for(memory, settings, PATIENCE)
    if (_is_unusual(memory, settings) or loud) and memory[Slot.EFFORT] > EFFORT:
        steady = memory[Slot.LEVEL] < STEADY * memory[Slot.PAST]
        _pause(memory)
        memory[Slot.PEEK] = Peek.POSSIBLE.value if steady else Peek.NO.value
    return Verdict.NONE


@njit
def _peek(memory, settings, y):
    """PAUSING: whether the power has risen as soon as the law was off, so that the law had calmed it."""
    if int(memory[Slot.PEEK]) != Peek.POSSIBLE or memory[Slot.CLOCK] < FADE_TIME:
        return False
    dt = settings[Setting.DT]
    memory[Slot.BLOCK] += y * y * dt
    memory[Slot.BLOCK_TIME] += dt
    if memory[Slot.BLOCK_TIME] < PEEK_TIME:
        return False
    power = memory[Slot.BLOCK] / memory[Slot.BLOCK_TIME]
    memory[Slot.BLOCK] = memory[Slot.BLOCK_TIME] = 0.0
    memory[Slot.PEEK] = Peek.NO.value
    if power < RISEN * max(memory[Slot.BEFORE], memory[Slot.BASE]):
        return False
    memory[Slot.PEEK] = Peek.TO_CONFIRM.value
    memory[Slot.BASE_BEFORE] = memory[Slot.BASE]
    memory[Slot.BASE] = power
    memory[Slot.LEVEL] = power
    _go(memory, State.RETURNING)
    return True


@njit
def _is_unusual(memory, settings):
    """Whether the power has been far above its usual one under control for long: then the base is measured anew."""
    dt = settings[Setting.DT]
    memory[Slot.ACTED] += dt
    settled = memory[Slot.ACTED] - SETTLE_TIME
    if settled <= 0.0:
        return False
    limit = UNUSUAL * _limit(memory[Slot.SLOW], settings)
    usual = memory[Slot.LEVEL] < max(limit, WELL_BELOW * memory[Slot.BASE])
    if usual or memory[Slot.QUICK] < 0.5 * memory[Slot.LEVEL]:
        memory[Slot.STRANGE] = max(memory[Slot.STRANGE] - dt, 0.0)
    else:
        memory[Slot.STRANGE] += dt
    if settled <= dt:
        memory[Slot.SLOW] = memory[Slot.LEVEL]
    change = memory[Slot.LEVEL] - memory[Slot.SLOW]
    memory[Slot.SLOW] += change * dt / (FALL_TIME if change < 0.0 else RISE_TIME)
    return memory[Slot.STRANGE] > max(memory[Slot.PATIENCE], PATIENCE_UNUSUAL)


@njit
def _listen_in_pause(memory, settings, y):
    """PAUSING: True once the power no longer falls; the base is then the power of the last block."""
    dt = settings[Setting.DT]
    memory[Slot.CLOCK] += dt
    if memory[Slot.CLOCK] < FADE_TIME + RING_TIME:
        return False
    memory[Slot.BLOCK] += y * y * dt
    memory[Slot.BLOCK_TIME] += dt
    if memory[Slot.BLOCK_TIME] < BLOCK_TIME:
        return False
    power = memory[Slot.BLOCK] / memory[Slot.BLOCK_TIME]
    falls = power < FALLING * memory[Slot.LAST_BLOCK]
    memory[Slot.LAST_BLOCK] = power
    memory[Slot.BLOCK] = memory[Slot.BLOCK_TIME] = 0.0
    if falls and memory[Slot.CLOCK] < LONGEST_PAUSE:
        return False
    memory[Slot.LEVEL] = power
    memory[Slot.QUICK] = power
    return True


@njit
def _judge(memory):
    """At the end of a pause."""
    heard = memory[Slot.LEVEL]
    fell = memory[Slot.BEFORE] > 2.0 * heard
    verdict = Verdict.NONE
    if not fell:
        memory[Slot.PATIENCE] = min(
            2.0 * max(memory[Slot.PATIENCE], PATIENCE_UNUSUAL), FORGIVE_TIME
        )
        memory[Slot.BASE] = heard
        _go(memory, State.RETURNING)
        return verdict
    memory[Slot.BASE] = min(memory[Slot.BASE], heard) if memory[Slot.BASE] > 0.0 else heard
    if memory[Slot.STRUCK] == 0.0:
        memory[Slot.PAUSES] += 1.0
        if memory[Slot.PAUSES] > 1.0:
            verdict = _strike(memory)
    _go(memory, State.WAITING)
    return verdict


@njit
def _wait(memory, settings):
    """WAITING: quiet until it is this strut's turn; the countdown begins anew when another one is loud."""
    dt = settings[Setting.DT]
    if memory[Slot.QUICK] > _limit(memory[Slot.BASE], settings):
        memory[Slot.QUIET] = 0.0
        memory[Slot.LOUD] += dt
        if memory[Slot.LOUD] > ALLOWED_TIME:
            memory[Slot.BASE] = memory[Slot.LEVEL]
    else:
        memory[Slot.LOUD] = 0.0
        memory[Slot.QUIET] += dt
    if memory[Slot.QUIET] >= TURN * settings[Setting.ORDER]:
        _go(memory, State.RETURNING)


@njit
def _return(memory, settings):
    """RETURNING: the voltage comes back; to be loud now is a strike."""
    memory[Slot.CLOCK] += settings[Setting.DT]
    if _is_loud_for(memory, settings, PATIENCE_RETURNING) and memory[Slot.EFFORT] > EFFORT:
        verdict = _strike(memory)
        _pause(memory)
        memory[Slot.STRUCK] = 1.0
        return verdict
    if int(memory[Slot.PEEK]) == Peek.TO_CONFIRM and memory[Slot.CLOCK] > RETURN_TIME + LEVEL_TIME:
        memory[Slot.PEEK] = Peek.NO.value
        if memory[Slot.LEVEL] > CALMED * memory[Slot.BASE]:
            memory[Slot.BASE] = memory[Slot.BASE_BEFORE]
            _pause(memory)
            return Verdict.NONE
    if memory[Slot.CLOCK] > TURN:
        _go(memory, State.ACTING)
    return Verdict.NONE


@njit
def _one(memory, settings, y, effort, acting, silent):
    """One sample of one strut: the share of the law's voltage and the verdict."""
    _measure(memory, settings, y, effort)
    if not acting:
        _listen(memory, settings, y, silent)
        memory[Slot.STATE] = State.LISTENING.value
        return memory[Slot.SHARE], Verdict.NONE
    state, verdict = int(memory[Slot.STATE]), Verdict.NONE
    if state == State.LISTENING:
        _go(memory, State.ACTING)
    elif state == State.ACTING:
        verdict = _act(memory, settings)
    elif state == State.PAUSING:
        if not _peek(memory, settings, y) and _listen_in_pause(memory, settings, y):
            verdict = _judge(memory)
    elif state == State.WAITING:
        _wait(memory, settings)
    else:
        verdict = _return(memory, settings)
    state = int(memory[Slot.STATE])
    if state == State.PAUSING:
        return memory[Slot.SHARE] * max(1.0 - memory[Slot.CLOCK] / FADE_TIME, 0.0), verdict
    if state == State.WAITING:
        return 0.0, verdict
    if state == State.RETURNING:
        return memory[Slot.SHARE] * min(memory[Slot.CLOCK] / RETURN_TIME, 1.0), verdict
    return memory[Slot.SHARE], verdict


@kernel(
    'void(f8, f8, f8, f8, f8[:], f8[:], f8[:], f8[:])',
    '(),(),(),(),(s),(m)->(),()',
    writable=('memory',),
)
def watch_step(y, effort, acting, silent, settings, memory, share, verdict):
    """Judge a sample: the share of the law's voltage that is let through, and the `Verdict`; see `VibrationWatch`."""
    share[0], code = _one(memory, settings, y, effort, acting > 0.0, silent > 0.0)
    verdict[0] = code.value


def settings_of(dt: float, floor: float, ratio: float, order: Array) -> Array:
    """Give the settings (*shape, 4): s, m/s^2, ratio of powers, turns that each strut waits (shape)."""
    settings = np.zeros((*order.shape, len(Setting)))
    settings[..., Setting.DT] = dt
    settings[..., Setting.FLOOR] = floor
    settings[..., Setting.RATIO] = ratio
    settings[..., Setting.ORDER] = order
    return settings


def fresh_memory(shape: tuple[int, ...]) -> Array:
    """Give the memory before the first sample."""
    memory = np.zeros((*shape, len(Slot)))
    memory[..., Slot.SHARE] = 1.0
    return memory


def is_off(memory: Array) -> Mask:
    """Where (shape) the voltage is taken off."""
    state = memory[..., Slot.STATE]
    return np.asarray((state == State.PAUSING) | (state == State.WAITING))


@kernel('void(f8[:], b1[:])', '(s)->()')
def is_back(memory, back):
    """Where (shape) the law acts as if nothing had been: no pause, no strike."""
    back[0] = int(memory[Slot.STATE]) < State.PAUSING and not memory[Slot.SHARE] < 1.0


def is_reduced(memory: Array) -> Mask:
    """Where (shape) the law has less than its own voltage."""
    return np.asarray(memory[..., Slot.SHARE] < 1.0)


def forgive(memory: Array, mask: Mask) -> None:
    """Forget strikes and pauses where (shape) `mask` holds; the base stays."""
    for slot, value in (
        (Slot.STATE, State.LISTENING), (Slot.SHARE, 1.0), (Slot.STRIKES, 0.0), (Slot.PAUSES, 0.0),
        (Slot.PEACE, 0.0), (Slot.LOUD, 0.0),
    ):  # fmt: skip
        memory[..., slot] = np.where(mask, value, memory[..., slot])
