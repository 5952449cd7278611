# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample of law narrowband: disturbance observer, tones, voltage, margin, back-off; see `narrowband`.

The voltage of a tone is faded in over two wanted paces, and slower after it did harm (`tone_watch`), so that a model
with a wrong phase turns the tracked tone slowly. While a tone is being caught its frequency is in doubt by 3 / N rad,
and where |G|^2 over that doubt is more in the mean than at the frequency, as beside a zero of the plant,
G* / mean |G|^2 stands in the place of 1 / G.
"""

import math

import numpy as np
from numba import njit
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.direct_form import filter_sample

from satvib_control.laws.narrowband.backoff import RING_DOWN, believe, held, lost
from satvib_control.laws.narrowband.margin import stretch
from satvib_control.laws.narrowband.model_correction import (
    attend,
    conclude,
    corrected,
    correction,
    fresh,
    learn,
    turned,
)
from satvib_control.laws.narrowband.search import HOPS_PER_WINDOW, search
from satvib_control.laws.narrowband.tracker import (
    ACTIVE,
    FADE,
    FADED,
    HOLD,
    IM,
    MEMORY,
    OMEGA,
    ON,
    PACE,
    POINTER,
    RE,
    SEEN,
    SENSITIVITY,
    SILENT,
    SLOW,
    STRETCH,
    TOP,
    TROUBLE,
    VOLTAGE,
    WANTED,
    correct,
    predict,
    prune,
)  # fmt: skip
from satvib_control.model_analysis.transfer import respond

# places in what the step shows
SHOW_ERROR, SHOW_OMEGA, SHOW_VOLTS, SHOW_PEAK = range(4)
SHOW_MOVING, SHOW_LIMITED, SHOW_HELD, SHOW_SLOW = range(4, 8)
SHOW = 8
RAMP = 0.5
UNSURE = 3.0


@njit
def _observe(b, a, state, lesson, applied, y):
    """Give d = y - G u: step the model by the voltage of the sample before; its first coefficient is 0."""
    filter_sample(b, a, state, applied)
    return y - corrected(lesson, state[0])


@njit
def _track(settings, common, tones, rings, floor, d, valid):
    """Take a sample of the disturbance; give the error, whether a search was due, and whether the tracker was lost."""
    window = rings.shape[1]
    step = math.pi / window
    expected = predict(tones)
    if not valid:
        return 0.0, False, False
    e = d - expected
    correct(tones, settings, common, floor[0], step, e)
    pointer = int(common[POINTER])
    rings[0, pointer] = e
    rings[1, pointer] = d
    common[POINTER] = float((pointer + 1) % window)
    common[SEEN] += 1.0
    astray = lost(common, settings, e, d)
    if astray:
        common[TROUBLE] = 0.0
        common[TOP] = 0.0
        rings[0, :] = rings[1, :]
        for i in range(tones.shape[0]):
            tones[i, ON] = 0.0
    hop = max(window // HOPS_PER_WINDOW, 1)
    if common[SEEN] >= window and int(common[SEEN]) % hop == 0:
        prune(tones, settings, floor[0], step, window)
        search(tones, settings, common, rings[0], floor, step)
        return e, True, astray
    return e, False, astray


@njit
def _respond(b, a, lesson, omega):
    return respond(b, a, omega) * correction(lesson, omega)


@njit
def _invert(b, a, lesson, t, settings):
    """What x is multiplied by: 1 / G, and while the tone is being caught G* / mean |G|^2 where that is less."""
    response = _respond(b, a, lesson, t[OMEGA])
    power = abs(response) ** 2
    if power == 0.0:
        return 0.0j
    missing = 1.0 - t[MEMORY] / (6.0 * settings[WANTED])
    if missing > 0.0:
        doubt = UNSURE * missing / t[MEMORY]
        below = abs(_respond(b, a, lesson, max(t[OMEGA] - doubt, 0.0))) ** 2
        above = abs(_respond(b, a, lesson, min(t[OMEGA] + doubt, math.pi))) ** 2
        power = max(power, (below + power + above) / 3.0)
    return response.conjugate() / power


@njit
def _share(volts, limit, share):
    """Share a voltage limit among amplitudes, the small ones first; True where somebody got less."""
    count = volts.shape[0]
    order = np.argsort(volts)
    rest = limit
    short = False
    for j in range(count):
        i = order[j]
        fair = rest / (count - j)
        share[i] = 1.0
        if volts[i] > fair:
            share[i] = fair / volts[i]
            short = True
        rest -= volts[i] * share[i]
    return short


@njit
def one(design, memory, y, applied, valid, act, show):
    """One sample of one item: give the voltage.

    Args:
        design: b, a, settings, points of the margin.
        memory: model's state, common, tones, rings, floor, lesson; changed.
        y: m/s^2.
        applied: V, between the sample before and this one.
        valid: y was measured.
        act: the voltage is used.
        show: changed.
    """
    b, a, settings, points = design
    state, common, tones, rings, floor, lesson = memory
    count = tones.shape[0]
    d = _observe(b, a, state, lesson, applied, y)
    e, searched, astray = _track(settings, common, tones, rings, floor, d, valid)
    inverse = np.zeros(count, dtype=np.complex128)
    volts = np.zeros(count)
    share = np.zeros(count)
    strongest, omega = 0.0, 0.0
    show[SHOW_MOVING] = 0.0
    show[SHOW_HELD] = 0.0
    for i in range(count):
        t = tones[i]
        if t[ON] == 0.0:
            continue
        inverse[i] = _invert(b, a, lesson, t, settings)
        if inverse[i] == 0.0:
            continue
        amplitude = math.sqrt(t[RE] * t[RE] + t[IM] * t[IM])
        volts[i] = amplitude * abs(inverse[i])
        show[SHOW_MOVING] = 1.0
        if amplitude > strongest:
            strongest, omega = amplitude, t[OMEGA]
    show[SHOW_OMEGA] = omega if strongest > 0.0 else np.nan
    short = _share(volts, settings[VOLTAGE], share)
    rest = common[HOLD] > 0.0
    if valid:
        rest, begins, guilty = held(common, settings, y, d, act, astray and turned(lesson))
        if begins:
            for i in range(count):
                tones[i, ON] = 0.0
        if guilty and conclude(lesson, omega):
            believe(common, settings)
    act = act and not rest
    anew = fresh(lesson) or common[SILENT] > RING_DOWN * settings[WANTED]
    if act and strongest > 0.0 and anew:
        attend(lesson, omega)
    elif valid and act:
        learn(lesson, settings, omega, y, y - d)
    show[SHOW_HELD] = 1.0 if rest else 0.0
    u = 0.0
    for i in range(count):
        t = tones[i]
        if t[ON] == 0.0 or volts[i] == 0.0:
            continue
        inverse[i] *= share[i]
        if act and t[PACE] > 0.0:
            t[FADE] = min(t[FADE] + RAMP / (settings[WANTED] * common[SLOW] ** 2), 1.0)
        elif not act:
            t[FADE] = 0.0
        u -= t[FADE] * (t[RE] * inverse[i].real - t[IM] * inverse[i].imag)
    if searched:
        stretch(tones, inverse, points, lesson, settings, common)
    total, most = 0.0, 0.0
    for i in range(count):
        total += volts[i] * share[i] * tones[i, FADE]
        if volts[i] > 0.0:
            most = max(most, tones[i, FADE])
    common[ACTIVE] = total
    common[FADED] = most
    show[SHOW_ERROR] = e
    show[SHOW_VOLTS] = total
    show[SHOW_PEAK] = common[SENSITIVITY]
    show[SHOW_LIMITED] = 1.0 if short else 0.0
    show[SHOW_SLOW] = 1.0 if common[STRETCH] > 1.0 else 0.0
    return u


# b, a, settings, points; model's state, common, tones, rings, floor, lesson
ITEM = 'f8[:], f8[:], f8[:], f8[:,:], f8[:], f8[:], f8[:,:], f8[:,:], f8[:,:], f8[:]'
LAYOUT = '(m),(m),(p),(q,r),(k),(c),(t,s),(z,w),(f,g),(e)'
WRITABLE = ('state', 'c', 'tones', 'rings', 'floor', 'lesson', 'show')


@kernel(f'void({ITEM}, f8, f8, f8, f8, f8[:], f8[:])', f'{LAYOUT},(),(),(),(),(h)->()', WRITABLE)
def narrowband_step(
    b, a, s, points, state, c, tones, rings, floor, lesson, y, applied, valid, act, show, u,
):  # fmt: skip
    """Give the voltage of one sample; see `one`. `valid`: 1, 0, or -1 where there is no model: nothing is done."""
    if valid < 0.0:
        u[0] = 0.0
        return
    memory = (state, c, tones, rings, floor, lesson)
    u[0] = one((b, a, s, points), memory, y, applied, valid > 0.0, act > 0.0, show)


@kernel(f'void({ITEM}, f8[:,:], f8, f8, f8[:], f8[:])', f'{LAYOUT},(l,v),(),(),(h)->()', WRITABLE)
def narrowband_replay(
    b, a, s, points, state, c, tones, rings, floor, lesson, past, begin, follow, show, done,
):  # fmt: skip
    """Run over the past, whose oldest row is at `begin`.

    Args:
        past: (l, 3) y, voltage before it, and 1: measured, 0: not measured, -1: no such sample.
        follow: 1: model and tones, 0: the model alone, -1: nothing.
        done: out, samples run.
    """
    length = past.shape[0]
    done[0] = 0.0
    act = follow > 1.0  # False, of the type that the step has
    for i in range(length):
        row = past[(int(begin) + i) % length]
        if row[2] < 0.0 or follow < 0.0:
            continue
        if follow > 0.0:
            c[ACTIVE] = (
                1.0  # nothing is learnt there of the strut at 0 V: the others may have been excited
            )
            memory = (state, c, tones, rings, floor, lesson)
            one((b, a, s, points), memory, row[0], row[1], row[2] > 0.0, act, show)
        else:
            _observe(b, a, state, lesson, row[1], row[0])
        done[0] += 1.0
