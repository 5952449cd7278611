# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample of the vibration watch, for one strut; the states are explained in `vibration_watch`."""

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

from satvib_control.core.vibration_memory import Peek, Setting, Slot, State, Verdict

LEVEL_TIME, QUICK_TIME = 0.5, 0.06  # s; two periods of the lowest tone that matters
PAST_TIME, BASE_TIME = 1.0, 1.5  # s
MOST = 4.0  # a level of 10 dB counts four times
PATIENCE = 1.0  # s
NEAR = 0.63  # of the limit of loud, -2 dB: what is between the samples may be the rest
PATIENCE_NEAR = 3.0  # s, of RETURNING and ACTING
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
LONGEST_WAIT = STRIKES * ALLOWED_TIME  # s beyond its turn: another strut has failed by then
FORGIVE_TIME = 60.0  # s
FALL_TIME, RISE_TIME = 1.0, 30.0  # s; the usual level follows down quickly and up slowly
SETTLE_TIME = 1.0  # s of ACTING before the usual level is learnt
# 4 dB more than loud above the usual level under control: the base may be of another time
UNUSUAL = 2.5
WELL_BELOW = 0.1  # 10 dB below the base nothing is unusual: an open loop rarely falls by more
PATIENCE_UNUSUAL = 1.5  # s; doubles with each pause that shows the law was not the cause
# s at the level of the base, longer at a lower one, until the base is heard again; doubles where the law was not the
# cause and the level stays what it is
DOUBT, LONGEST_DOUBT = 2.0, 16.0
GUESSED_DOUBT = (
    1.0  # s; the same where the base is that of a peek, which may have heard a mode that rings
)
FALLS = 0.8  # of the level of a second ago: it falls by itself, or is random
FIRST_TIME = 5.0  # s of CONTROL before the level counts as settled
RISE_COUNTS = 2.0  # s at the end of these in which a rise counts
OTHER = 1.5  # ratio of powers: another level is another doubt
BELOW = 2.5  # the base is 4 dB below the usual limit
FAR_BELOW = 0.05  # 13 dB below the base there is no doubt
CALMS = 0.5  # of the base; so much is lost by a whole pause that a peek comes first
EFFORT = 1e-7  # (0.03 % of the limit)^2: at 0 V the law is not the cause


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
def _is_nearly_loud_for(memory, settings):
    """Count how long it has been nearly loud."""
    limit = NEAR * _limit(memory[Slot.BASE], settings)
    dt = settings[Setting.DT]
    if memory[Slot.LEVEL] <= limit or memory[Slot.QUICK] <= limit:
        memory[Slot.NEARLY] = max(memory[Slot.NEARLY] - dt, 0.0)
    elif memory[Slot.QUICK] >= 0.5 * memory[Slot.LEVEL]:
        memory[Slot.NEARLY] += dt
    return memory[Slot.NEARLY] > PATIENCE_NEAR


@njit
def _pause(memory):
    """Begin a pause."""
    memory[Slot.BEFORE] = memory[Slot.LEVEL]
    memory[Slot.BLOCK] = memory[Slot.BLOCK_TIME] = 0.0
    memory[Slot.LAST_BLOCK] = np.inf
    memory[Slot.STRUCK] = memory[Slot.PEACE] = memory[Slot.NEARLY] = 0.0
    memory[Slot.ACTED] = memory[Slot.STRANGE] = 0.0
    memory[Slot.PEEK] = Peek.NO.value
    memory[Slot.DOUBT] = memory[Slot.LOOK] = 0.0
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
    loud = _is_nearly_loud_for(memory, settings) or loud
    loud = _is_unusual(memory, settings) or loud
    doubted = _is_doubted(memory, settings)
    if (loud or doubted) and memory[Slot.EFFORT] > EFFORT:
        peeks = memory[Slot.LEVEL] < STEADY * memory[Slot.PAST]
        if not loud:
            peeks = peeks and memory[Slot.LEVEL] < CALMS * memory[Slot.BASE]
        _pause(memory)
        memory[Slot.LOOK] = 0.0 if loud else 1.0
        memory[Slot.PEEK] = Peek.POSSIBLE.value if peeks else Peek.NO.value
    return Verdict.NONE


@njit
def _is_doubted(memory, settings):
    """Whether the open loop may have fallen for so long that the base is to be heard again."""
    dt = settings[Setting.DT]
    first = memory[Slot.CHANGED]
    if first < 0.0:
        memory[Slot.CHANGED] = min(first + dt, 0.0)
    if memory[Slot.ACTED] <= SETTLE_TIME or first < -RISE_COUNTS:
        memory[Slot.LOOKED] = memory[Slot.PAST]
    elif memory[Slot.PAST] > memory[Slot.LOOKED] * OTHER:
        memory[Slot.LOOKED] = memory[Slot.PAST]
        memory[Slot.CHANGED] = 1.0
        memory[Slot.DOUBT_TIME] = min(memory[Slot.DOUBT_TIME], DOUBT)
    elif memory[Slot.PAST] * OTHER < memory[Slot.LOOKED]:
        memory[Slot.LOOKED] = memory[Slot.PAST]
        if first >= 0.0:
            memory[Slot.CHANGED] = 1.0
    if memory[Slot.LEVEL] < FALLS * memory[Slot.PAST]:
        memory[Slot.DOUBT] = 0.0
    elif memory[Slot.CHANGED] > 0.0 and memory[Slot.LEVEL] > _limit(0.0, settings):
        part = BELOW * memory[Slot.LEVEL] / _limit(memory[Slot.BASE], settings)
        if part > FAR_BELOW:
            memory[Slot.DOUBT] += min(np.sqrt(part), 1.0) * dt
    return memory[Slot.DOUBT] > memory[Slot.DOUBT_TIME]


@njit
def _doubt_less(memory):
    """The law was not the cause."""
    memory[Slot.CHANGED] = 0.0
    memory[Slot.DOUBT_TIME] = min(2.0 * max(memory[Slot.DOUBT_TIME], DOUBT), LONGEST_DOUBT)


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
    looks = memory[Slot.LOOK] > 0.0
    if power < RISEN * max(memory[Slot.BEFORE], 0.0 if looks else memory[Slot.BASE]):
        return False
    if looks:
        _doubt_less(memory)
        _go(memory, State.RETURNING)
        return True
    memory[Slot.CHANGED], memory[Slot.DOUBT_TIME] = 1.0, GUESSED_DOUBT
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
    """PAUSING: True once the power no longer falls; the base is then the power of the last block.

    A ring and the disturbance beat, so that the power may stand still for a block while the strut still rings. A strut
    with a strike is probably the cause again: it is heard until it is at half its power, or for the longest pause.
    """
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
    rings = memory[Slot.STRIKES] > 0.0 and 2.0 * power > memory[Slot.BEFORE]
    if (falls or rings) and memory[Slot.CLOCK] < LONGEST_PAUSE:
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
        if memory[Slot.LOOK] == 0.0:
            memory[Slot.PATIENCE] = min(
                2.0 * max(memory[Slot.PATIENCE], PATIENCE_UNUSUAL), FORGIVE_TIME
            )
        _doubt_less(memory)
        memory[Slot.BASE] = heard
        _go(memory, State.RETURNING)
        return verdict
    memory[Slot.BASE] = min(memory[Slot.BASE], heard) if memory[Slot.BASE] > 0.0 else heard
    memory[Slot.CHANGED], memory[Slot.DOUBT_TIME] = 0.0, DOUBT
    if memory[Slot.STRUCK] == 0.0 and memory[Slot.LOOK] == 0.0:
        memory[Slot.PAUSES] += 1.0
        if memory[Slot.PAUSES] > 1.0:
            verdict = _strike(memory)
    _go(memory, State.WAITING)
    return verdict


@njit
def _wait(memory, settings):
    """WAITING: quiet until it is this strut's turn; the countdown begins anew when another one is loud.

    Random vibration passes the limit for moments again and again, and no countdown would ever end. What has been heard
    for the longest wait is the disturbance.
    """
    dt = settings[Setting.DT]
    memory[Slot.CLOCK] += dt
    if memory[Slot.QUICK] > _limit(memory[Slot.BASE], settings):
        memory[Slot.QUIET] = 0.0
        memory[Slot.LOUD] += dt
        if memory[Slot.LOUD] > ALLOWED_TIME:
            memory[Slot.BASE] = memory[Slot.LEVEL]
    else:
        memory[Slot.LOUD] = 0.0
        memory[Slot.QUIET] += dt
    turn = TURN * settings[Setting.ORDER]
    if memory[Slot.CLOCK] > turn + LONGEST_WAIT:
        memory[Slot.BASE] = max(memory[Slot.BASE], memory[Slot.PAST])
        _go(memory, State.RETURNING)
    elif memory[Slot.QUIET] >= turn:
        _go(memory, State.RETURNING)


@njit
def _return(memory, settings):
    """RETURNING: the voltage comes back; to be loud now is a strike."""
    memory[Slot.CLOCK] += settings[Setting.DT]
    _is_nearly_loud_for(memory, settings)
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
        memory[Slot.DOUBT], memory[Slot.DOUBT_TIME] = 0.0, DOUBT
        memory[Slot.CHANGED], memory[Slot.NEARLY] = -FIRST_TIME, 0.0
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
