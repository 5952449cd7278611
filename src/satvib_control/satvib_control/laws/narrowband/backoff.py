# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Two watches over law narrowband: over the tracker, and over what the voltage does.

`lost`: for a whole window the tones have explained less than four fifths of the disturbance, though there is more
than four times the usual error. Then the tracker is beyond catching up (three tones that jumped at once, say), and
the law seeks anew in the window, which by then holds the new tones only.

`held`: whether the law has to be at 0 V. A model whose phase at the tone is wrong by 80 degrees or more makes the
voltage feed what it is to cancel, and explains the growth as one of the disturbance: no test of the model by the model
can see that. So the vibration is compared with its own power at 0 V, the base, which is learnt only while the law's
voltage is 0. Suspect is

    loud       y^2 > 2 base, the longer and the louder: five paces of it, less the more it is above,
    quick      y^2 > 4 base, and what the model thinks the voltage does is large enough to be the cause,
    useless    y^2 > 0.7 base for 20 paces on balance,
    astray     the tracker is lost, and the attempt shows clearly that the model is turned.

The law then goes to 0 V for at least ten paces, rings down and listens. If the vibration falls by half it was guilty
(useless and astray always are): the next hold is four times as long, and it comes back twice as slow, fades in four
times as slowly, and 1.4 base is enough for the next suspicion. If not, it listens twice as long again, for the growth
may be the work of another strut that is about to give up as well, and then takes what it hears for its new base. The
base is the least of a hold, not the last, for the same reason. Means are over a pace, in a hold over four. Success, y^2
below a tenth of base, shortens the next hold by an e-fold in 100 paces. A law that has to act before it has listened
takes what it finds for its base until the first hold, which is then not prolonged.

Where the attempt was loud or astray and has shown what is wrong with the model (`tone_response`), the next hold is as
the first again, and the law comes back four times as slow as it began: struts that learn at once disturb each other
less so.
"""

import math

from numba import njit

from satvib_control.laws.narrowband.tracker import (
    ACTIVE,
    BASE,
    BEFORE,
    EXTENDED,
    FADED,
    FIRST_HOLD,
    FRESH,
    HEARD,
    HOLD,
    KNOWN,
    LEAST,
    LEVEL,
    LOUD,
    NEXT_HOLD,
    POWER_D,
    POWER_E,
    POWER_U,
    POWER_Y,
    QUIET,
    RECENT,
    REST,
    SEEN,
    SILENT,
    SLOW,
    STRETCH,
    TELLING,
    TROUBLE,
    USELESS,
    WANTED,
    WINDOW,
)  # fmt: skip

GROWN, BELIEVED_LESS = 2.0, 1.4
PATIENCE = 5.0  # paces
RING_DOWN = 4.0  # paces at 0 V before anything is learnt of the strut
LONGEST_HOLD = 600.0  # first holds
CAREFUL = 4.0  # times slower with a corrected model


@njit
def lost(common, settings, e, d):
    """Whether for a whole window the tones have explained less than four fifths of the disturbance."""
    window = settings[WINDOW]
    common[POWER_E] += (e * e - common[POWER_E]) * 4.0 / window
    common[POWER_D] += (d * d - common[POWER_D]) * 4.0 / window
    weight = 0.02 if common[SEEN] - common[FRESH] < window else 1.0
    common[QUIET] += (common[POWER_E] - common[QUIET]) * weight / min(16.0 * window, common[SEEN])
    if common[POWER_E] > 0.2 * common[POWER_D] and common[POWER_E] > 4.0 * common[QUIET]:
        common[TROUBLE] += 1.0
    else:
        common[TROUBLE] = max(common[TROUBLE] - 4.0, 0.0)
    return common[TROUBLE] > window


@njit
def held(common, settings, y, d, acting, astray):
    """Whether the law has to be at 0 V, whether that begins with this sample, and whether a guilty attempt may teach.

    Args:
        common: changed.
        settings: of the law.
        y: m/s^2.
        d: m/s^2; y - G u.
        acting: the law's voltage is let through in this phase.
        astray: the tracker was lost in an attempt with a model that is turned (`tone_response`).
    """
    _listen(common, settings, y, y - d)
    if common[HOLD] > 0.0:
        common[HOLD] -= 1.0
        proved = common[HOLD] <= 0.0 and _judge(common, settings)
        return common[HOLD] > 0.0, False, proved
    if not acting or common[ACTIVE] == 0.0:
        common[LOUD], common[USELESS] = 0.0, 0.0
        return False, False, False
    if common[BASE] == 0.0:
        common[BASE] = common[LEVEL]
    loud, useless = _suspicious(common, settings[WANTED])
    if not (loud or useless or astray):
        return False, False, False
    common[BEFORE] = common[LEVEL] if loud else math.inf
    common[TELLING] = 1.0 if loud or astray else 0.0
    common[LEAST] = math.inf
    common[LOUD], common[USELESS] = 0.0, 0.0
    common[EXTENDED] = 0.0 if common[KNOWN] > 0.0 else 1.0
    common[HOLD] = max(common[NEXT_HOLD], settings[FIRST_HOLD])
    return True, True, False


@njit
def believe(common, settings):
    """The model was corrected after the verdict: the next hold is as the first, and it comes back slowly."""
    common[NEXT_HOLD] = settings[FIRST_HOLD]
    common[SLOW] = max(common[SLOW], CAREFUL)


@njit
def _listen(common, settings, y, effect):
    """Take a sample into the powers, and at 0 V into the base."""
    wanted = settings[WANTED]
    common[HEARD] += 1.0
    common[LEVEL] += (y * y - common[LEVEL]) * max(1.0 / wanted, 1.0 / common[HEARD])
    common[POWER_Y] += (y * y - common[POWER_Y]) * 2.0 / wanted
    common[POWER_U] += (effect * effect - common[POWER_U]) * 2.0 / wanted
    common[RECENT] *= 1.0 - 0.1 / wanted
    if common[POWER_U] < common[POWER_Y] / 16.0:
        common[RECENT] = max(common[RECENT], common[POWER_Y])
    if common[SILENT] <= RING_DOWN * wanted:
        common[REST] = common[LEVEL]
    common[SILENT] = common[SILENT] + 1.0 if common[ACTIVE] == 0.0 else 0.0
    if common[SILENT] > RING_DOWN * wanted:
        if common[HOLD] > 0.0:
            common[REST] += (common[LEVEL] - common[REST]) / (4.0 * wanted)
            common[LEAST] = min(common[LEAST], common[REST])
        else:
            common[BASE] += (common[LEVEL] - common[BASE]) / wanted
            common[KNOWN] = 1.0
    elif common[ACTIVE] > 0.0 and common[LEVEL] < 0.1 * common[BASE]:
        common[NEXT_HOLD] = max(common[NEXT_HOLD] * (1.0 - 0.01 / wanted), settings[FIRST_HOLD])


@njit
def _suspicious(common, wanted):
    """Whether it has been loud, and whether useless, for too long."""
    level, base = common[LEVEL], common[BASE]
    growth = level / ((GROWN if common[SLOW] == 1.0 else BELIEVED_LESS) * base + 1e-300)
    common[LOUD] = (
        common[LOUD] + min(growth, PATIENCE) if growth > 1.0 else max(common[LOUD] - 0.5, 0.0)
    )
    quick = (
        common[POWER_Y] > 4.0 * max(base, common[RECENT])
        and common[POWER_U] > 0.25 * common[POWER_Y]
    )
    if level > 0.7 * base and common[FADED] > 0.5:
        common[USELESS] += 1.0
    else:
        common[USELESS] = max(common[USELESS] - 4.0, 0.0)
    useless = common[USELESS] > 20.0 * wanted * max(0.5 * common[SLOW], 1.0)
    return quick or common[LOUD] > PATIENCE * wanted, useless


@njit
def _judge(common, settings):
    """At the end of a hold: was it the law, and what is the base; True: it was, and the attempt may teach."""
    first = settings[FIRST_HOLD]
    common[KNOWN] = 1.0
    if common[LEAST] < 0.5 * common[BEFORE]:
        common[NEXT_HOLD] = min(4.0 * max(common[NEXT_HOLD], first), LONGEST_HOLD * first)
        common[SLOW] = min(2.0 * common[SLOW], 8.0)
        common[STRETCH] = max(common[STRETCH], common[SLOW])
        common[BASE] = min(common[LEAST], common[BASE])
        return common[TELLING] > 0.0
    if common[EXTENDED] == 0.0:
        common[EXTENDED] = 1.0
        common[HOLD] = 2.0 * first
    else:
        common[BASE] = common[LEAST]
    return False
