# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Two watches over law narrowband: over the tracker, and over what the voltage does.

`lost`: for a whole window the tones have explained less than four fifths of the disturbance, though there is more
than four times the usual error. Then the tracker is beyond catching up (three tones that jumped at once, say), and
the law seeks anew in the window, which by then holds the new tones only.

`harmful`: the base is the power of y as it is without the voltage. It is learnt while the voltage has no effect (|G
u|^2 below 1/16 of y^2), and where y is less than a tenth of d = y - G u it follows d. The voltage does harm when
y^2 > 4 base with |G u|^2 > y^2 / 4, so the voltage is large enough to be the cause; and it is useless when y^2 >
0.7 base holds for 20 paces on balance. Both mean a model whose phase at the tone is wrong by 80 degrees or more.
The law then goes to 0 V for a pause that doubles each time, and comes back twice as slow (up to eight times), since
the slower it is the more it stands. Means are over half a wanted pace.
"""

from numba import njit

from satvib_control.tone_tracker import (
    BASE,
    FIRST_HOLD,
    FRESH,
    NEXT_HOLD,
    POWER_D,
    POWER_E,
    POWER_U,
    POWER_Y,
    QUIET,
    SEEN,
    SILENT,
    SLOW,
    TROUBLE,
    USELESS,
    WANTED,
    WINDOW,
)  # fmt: skip


@njit
def lost(common, settings, e, d):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
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
def harmful(common, settings, y, d, acting):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """Whether the voltage does harm, or for long no good."""
    wanted = settings[WANTED]
    effect = y - d
    common[POWER_Y] += (y * y - common[POWER_Y]) * 2.0 / wanted
    common[POWER_U] += (effect * effect - common[POWER_U]) * 2.0 / wanted
    if common[POWER_U] < common[POWER_Y] / 16.0:
        common[SILENT] = min(common[SILENT] + 1.0, 4.0 * wanted)
        if common[SILENT] > 2.0 * wanted:
            common[BASE] += (common[POWER_Y] - common[BASE]) / wanted
        common[BASE] = max(common[BASE], common[POWER_Y])
    elif common[POWER_Y] < 0.1 * common[POWER_D]:
        common[SILENT] = 0.0
        common[BASE] += (common[POWER_D] - common[BASE]) / (4.0 * wanted)
        common[NEXT_HOLD] = max(common[NEXT_HOLD] * (1.0 - 0.01 / wanted), settings[FIRST_HOLD])
    if not acting:
        common[USELESS] = 0.0
        return False
    if common[POWER_Y] > 0.7 * common[BASE] and common[POWER_U] > 0.25 * common[POWER_Y]:
        common[USELESS] += 1.0
    else:
        common[USELESS] = max(common[USELESS] - 4.0, 0.0)
    harm = common[POWER_Y] > 4.0 * common[BASE] and common[POWER_U] > 0.25 * common[POWER_Y]
    return harm or common[USELESS] > 20.0 * wanted * common[SLOW]
