# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""When feedforward may learn, when it may act, and when it backs off.

Listening. With its own voltage at 0 the law measures how much of the reference passes passively,

    r_0 = <y^2> / <x^2>,

over the watch time. In the second half of it it learns, since the modified form of `fxlms` needs no voltage for that,
and then lets its voltage in over another half: what comes out first has been learnt from many samples.

A vibration that is not from below. A payload that rings shakes the lower plate too. Where <d_hat^2> > 30^2 <x^2>
(while listening also <y^2>) the reference is too small for what it is to explain, for no passive isolator amplifies as
much, and nothing is learnt.

Backing off. A secondary path that is wrong by more than 90 degrees makes every gradient law climb instead of descend,
and no test that uses the model alone can see it. It is an alarm when

    <y^2> > R^2 max(r_0, 1) <x^2>   and   <(G_hat u)^2> > <y^2> / 4,

the residual being larger than ever without control and the voltage large enough to be the cause (y and u over a fifth
of the watch time, for what grows grows quickly); or when more than a third of the last samples were cut by the guard,
which is how a loop through a contaminated reference shows itself (x grows with y there). At an alarm the voltage fades
out within a tenth of the watch time, the weights are forgotten, the pace of adaptation drops to a quarter, and the law
listens anew, after a watch time in which the strut rings down: what rings is no measure of what passes, and neither is
what other struts shake, so r_0 is then at most what it was before the first alarm. A law that has failed is believed
less: after n alarms R^(1 / (n + 1)) over r_0 itself is enough for the next, and so are four watch times, on balance, in
which the residual is not a decibel below r_0 <x^2>. The third alarm ends the matter: 0 V until a new model or a reset.
Ten watch times in which it is, which no wrong path ever brings about, forgive one.
"""

from satvib_common.kernels.compile import kernel

LEARN, LISTEN, FADE, GIVEN_UP, RESTART = range(5)
ALARMS = 3
TRANSMISSION = 30.0
# places in the memory
ERROR, PASSIVE, REFERENCE, EFFECT, RAIL, BASE, HEARD, PACE, SHARE, COUNT = range(10)
CLOCK, QUICK, USELESS, PRIOR = range(10, 14)
SIZE = 14


@kernel(
    'void(f8, f8, f8, b1, b1, b1, f8[:], f8[:], i8[:], b1[:])',
    '(),(),(),(),(),(),(n),(m)->(),()',
    writable=('memory',),
)
def watch(error, reference, effect, cut, valid, acting, settings, memory, verdict, loud):
    """Judge one sample.

    Args:
        error: () residual y, m/s^2.
        reference: () x, m/s^2.
        effect: () G_hat u of the law's own voltage, m/s^2.
        cut: () bool; the guard cut that voltage.
        valid: () bool; all of it was measured, and nothing but the law and the disturbance acts.
        acting: () bool; the law's voltage is let through in this phase.
        settings: (3) samples of the watch time, R, floor of the reference (m/s^2, RMS).
        memory: (14) changed; the pace begins with 1, the rest with 0.
        verdict: () out: LEARN, LISTEN (learn, no voltage), FADE, RESTART (forget the weights) or GIVEN_UP.
        loud: () out: the reference is worth learning from.
    """
    window, ratio, floor = settings[0], settings[1], settings[2]
    loud[0] = False
    if memory[CLOCK] < 0.0:
        memory[CLOCK] += 1.0
        memory[SHARE] = max(memory[SHARE] - 1.0 / max(0.1 * window, 1.0), 0.0)
        verdict[0] = FADE
        if memory[CLOCK] >= 0.0:
            verdict[0] = RESTART
            if memory[PRIOR] == 0.0:
                memory[PRIOR] = memory[BASE]
            for i in (
                ERROR,
                PASSIVE,
                REFERENCE,
                EFFECT,
                RAIL,
                BASE,
                HEARD,
                SHARE,
                CLOCK,
                QUICK,
                USELESS,
            ):
                memory[i] = 0.0
            memory[HEARD] = -window  # rings down
        return
    if memory[COUNT] >= ALARMS:
        memory[SHARE] = 0.0
        verdict[0] = GIVEN_UP
        return
    if valid:
        memory[HEARD] += 1.0
    if memory[HEARD] < 0.0:
        verdict[0] = LISTEN
        return
    if valid and memory[HEARD] > 0.0:
        forget = max(1.0 / memory[HEARD], 1.0 / window)
        passive = error - effect
        memory[ERROR] += forget * (error * error - memory[ERROR])
        memory[PASSIVE] += forget * (passive * passive - memory[PASSIVE])
        memory[REFERENCE] += forget * (reference * reference - memory[REFERENCE])
        quick = max(1.0 / memory[HEARD], min(5.0 / window, 1.0))
        memory[QUICK] += quick * (error * error - memory[QUICK])
        memory[EFFECT] += quick * (effect * effect - memory[EFFECT])
        memory[RAIL] += ((1.0 if cut else 0.0) - memory[RAIL]) / window
    most = memory[PASSIVE]
    if memory[BASE] == 0.0:
        most = max(most, memory[ERROR])
    enough = memory[REFERENCE] * TRANSMISSION * TRANSMISSION >= most
    loud[0] = memory[REFERENCE] > floor * floor and enough
    if memory[BASE] == 0.0:
        verdict[0] = LISTEN
        if not loud[0]:
            memory[HEARD] = min(memory[HEARD], 0.5 * window)  # silence tells nothing
        elif memory[HEARD] >= window and valid:
            memory[BASE] = max(memory[ERROR] / memory[REFERENCE], 1e-300)
            if memory[PRIOR] > 0.0:
                memory[BASE] = min(memory[BASE], memory[PRIOR])
            memory[CLOCK] = 0.0
        # nothing is learnt from the onset: the reference is there before its filtered twin
        loud[0] = loud[0] and memory[HEARD] >= 0.75 * window
        return
    verdict[0] = LEARN
    if not acting:
        memory[SHARE] = 0.0
        return
    memory[SHARE] = min(memory[SHARE] + 1.0 / max(0.5 * window, 1.0), 1.0)
    if not valid:
        return
    good = memory[ERROR] < 0.8 * memory[BASE] * memory[REFERENCE]
    memory[CLOCK] += 1.0 if good else 0.0
    if memory[REFERENCE] > floor * floor:
        memory[USELESS] = max(memory[USELESS] + (-1.0 if good else 1.0), 0.0)
    if memory[CLOCK] >= 10.0 * window:
        memory[CLOCK] = 0.0
        memory[COUNT] = max(memory[COUNT] - 1.0, 0.0)
        if memory[COUNT] == 0.0:
            memory[PRIOR] = 0.0
        memory[PACE] = min(4.0 * memory[PACE], 1.0)
    growth = ratio ** (2.0 / (memory[COUNT] + 1.0))
    passive = max(memory[BASE], 1.0) if memory[COUNT] == 0.0 else memory[BASE]
    grown = memory[QUICK] > growth * passive * memory[REFERENCE]
    cause = 4.0 * memory[EFFECT] > memory[QUICK]
    useless = memory[COUNT] > 0.0 and memory[USELESS] > 4.0 * window
    harm = (grown and cause) or useless
    if (harm and memory[REFERENCE] > floor * floor) or memory[RAIL] > 1.0 / 3.0:
        memory[COUNT] += 1.0
        memory[PACE] *= 0.25
        memory[CLOCK] = -max(0.1 * window, 1.0)
        verdict[0] = FADE
