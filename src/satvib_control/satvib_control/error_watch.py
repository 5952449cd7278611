# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Backing off when the error grows: the last line of defence of an adaptive feedforward.

A secondary path that is wrong by more than 90 degrees makes every gradient law climb instead of descend, and no test
that uses the model alone can see it. So the law first listens: with its own voltage at 0 it measures

    r_0 = <y^2> / <x^2>,

how much of the reference passes passively. Later, with means over the watch time, it is an alarm when

    <y^2> > R^2 max(r_0, 1) <x^2>   and   <(G_hat u)^2> > <y^2> / 4,

the residual being larger than ever without control and the voltage large enough to be the cause; or when more than a
third of the last samples were saturated, which is how a loop through a contaminated reference shows itself (x grows
with y there). At an alarm the weights fade to nothing within a tenth of the watch time, the pace of adaptation drops to
a quarter, and the law listens anew. Ten watch times without an alarm forgive one. The third alarm in a row ends the
matter: 0 V until a new model or a reset.
"""

from satvib_common.kernel import kernel

LEARN, LISTEN, FADE, GIVEN_UP = 0, 1, 2, 3
ALARMS = 3
# places in the memory
ERROR, REFERENCE, EFFECT, BASE, HEARD, PACE, COUNT, CLOCK, RAIL = range(9)
SIZE = 9


@kernel(
    'void(f8, f8, f8, b1, b1, b1, f8[:], f8[:], i8[:])',
    '(),(),(),(),(),(),(n),(m)->()',
    writable=('memory',),
)
def watch(error, reference, effect, saturated, valid, acting, settings, memory, verdict):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """Judge one sample.

    Args:
        error: () residual y, m/s^2.
        reference: () x, m/s^2.
        effect: () G_hat u, m/s^2.
        saturated: () bool; the guard changed the voltage.
        valid: () bool; all of it was measured, and nothing but the law and the disturbance acts.
        acting: () bool; the law may act in this phase.
        settings: (3) samples of the watch time, R, floor of the reference (m/s^2, RMS).
        memory: (9) changed; the pace begins with 1, the rest with 0.
        verdict: () out: LEARN, LISTEN, FADE or GIVEN_UP.
    """
    window, ratio, floor = settings[0], settings[1], settings[2]
    if memory[CLOCK] < 0.0:  # fading: clock counts up to 0
        memory[CLOCK] += 1.0
        verdict[0] = FADE
        if memory[CLOCK] >= 0.0:
            memory[CLOCK] = 0.0
            for i in (ERROR, REFERENCE, EFFECT, BASE, HEARD, RAIL):
                memory[i] = 0.0
        return
    if memory[COUNT] >= ALARMS:
        verdict[0] = GIVEN_UP
        return
    if valid:
        memory[HEARD] += 1.0
        forget = max(1.0 / memory[HEARD], 1.0 / window)
        memory[ERROR] += forget * (error * error - memory[ERROR])
        memory[REFERENCE] += forget * (reference * reference - memory[REFERENCE])
        memory[EFFECT] += forget * (effect * effect - memory[EFFECT])
        memory[RAIL] += ((1.0 if saturated else 0.0) - memory[RAIL]) / window
    loud = memory[REFERENCE] > floor * floor
    if memory[BASE] == 0.0:
        if not loud:
            memory[HEARD] = min(memory[HEARD], 1.0)  # a mean over silence tells nothing
        elif memory[HEARD] >= window and valid:
            memory[BASE] = max(memory[ERROR] / memory[REFERENCE], 1e-300)
        verdict[0] = LISTEN if memory[BASE] == 0.0 else LEARN
        return
    verdict[0] = LEARN
    if not (valid and acting):
        return
    memory[CLOCK] += 1.0
    if memory[CLOCK] >= 10.0 * window:
        memory[CLOCK] = 0.0
        memory[COUNT] = max(memory[COUNT] - 1.0, 0.0)
        memory[PACE] = min(4.0 * memory[PACE], 1.0)
    grown = memory[ERROR] > ratio * ratio * max(memory[BASE], 1.0) * memory[REFERENCE]
    if (loud and grown and 4.0 * memory[EFFECT] > memory[ERROR]) or memory[RAIL] > 1.0 / 3.0:
        memory[COUNT] += 1.0
        memory[PACE] *= 0.25
        memory[CLOCK] = -max(0.1 * window, 1.0)
        verdict[0] = FADE
