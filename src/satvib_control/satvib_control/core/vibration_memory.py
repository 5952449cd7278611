# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the vibration watch remembers of a strut, and what is read from it; `vibration_watch` explains the states."""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel


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
    DOUBT = 25  # s for which the base may have been too high
    DOUBT_TIME = 26  # most of it
    LOOKED = 27  # power under control after the last pause
    LOOK = 28  # 1 where the pause is for a doubt
    CHANGED = 29  # 1 where the level has changed since then; below 0: s until that is asked
    NEARLY = 30  # how long it has been nearly loud


class Setting(IntEnum):
    """What the watch is told."""

    DT = 0
    FLOOR = 1  # m/s^2
    ORDER = 2  # turns that this strut waits
    RATIO = 3  # of powers, above which it is loud


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
