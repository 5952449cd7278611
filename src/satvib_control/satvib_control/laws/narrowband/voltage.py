# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltage of law narrowband: what the tones ask for, what the limit allows, and the fade-in.

The voltage of a tone is faded in over two wanted paces, and slower after it did harm (`backoff`), so that a model
with a wrong phase turns the tracked tone slowly. While a tone is being caught its frequency is uncertain by 3 / N rad.
Where the mean of |G|^2 over that uncertainty is more than |G|^2 at the frequency, as beside a zero of the plant,
G* / mean |G|^2 stands in the place of 1 / G.

With `narrowband_serve: payload` a tone's voltage is multiplied by a weight. It serves the payload between the samples
instead of the samples (`satvib_plant_sim.responses.images`).
"""

import math
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.kernels.deferred import njit

from satvib_control.laws.narrowband.memory import Backoff, Setting, Tone, Weight
from satvib_control.laws.narrowband.model_correction import factor
from satvib_control.laws.narrowband.tracker import PACES
from satvib_control.model_analysis.transfer import respond

FADE_IN = 0.5  # share per wanted pace
UNCERTAIN = 3.0  # rad; times 1 / N, uncertainty of the frequency while a tone is being caught


class Demand(NamedTuple):
    """What the tones ask for, (tones) each.

    Attributes:
        inverse: what x is multiplied by, V/(m/s^2).
        volts: V; amplitude of the voltage; 0 for a free place.
        share: of it that the voltage limit allows.
    """

    inverse: Complex
    volts: Array
    share: Array


@njit
def ask(design, memory):
    """Give what the tones ask for, the strongest one's frequency (rad/sample, 0: none) and whether there is any."""
    tones = memory.tones
    count = tones.shape[0]
    demand = Demand(np.zeros(count, dtype=np.complex128), np.zeros(count), np.zeros(count))
    strongest, omega, tracking = 0.0, 0.0, False
    for i in range(count):
        t = tones[i]
        if t[Tone.ON] == 0.0 or t[Tone.BARRED] > 0.0:
            continue
        demand.inverse[i] = _invert(design, memory.correction, t)
        if demand.inverse[i] == 0.0:
            continue
        if design.weights.shape[0] > 1:
            demand.inverse[i] *= weight(design.weights, t[Tone.OMEGA])
        amplitude = math.sqrt(t[Tone.RE] * t[Tone.RE] + t[Tone.IM] * t[Tone.IM])
        demand.volts[i] = amplitude * abs(demand.inverse[i])
        tracking = True
        if amplitude > strongest:
            strongest, omega = amplitude, t[Tone.OMEGA]
    return demand, omega, tracking


@njit
def _invert(design, correction, t):
    """What x is multiplied by: 1 / G, and while the tone is being caught G* / mean |G|^2 where that is less."""
    omega, memory = t[Tone.OMEGA], t[Tone.MEMORY]
    response = _response(design, correction, omega)
    power = abs(response) ** 2
    if power == 0.0:
        return 0.0j
    missing = 1.0 - memory / (PACES * design.settings[Setting.PACE])
    if missing > 0.0:
        width = UNCERTAIN * missing / memory
        below = abs(_response(design, correction, max(omega - width, 0.0))) ** 2
        above = abs(_response(design, correction, min(omega + width, math.pi))) ** 2
        power = max(power, (below + power + above) / 3.0)
    return response.conjugate() / power


@njit
def weight(weights, omega):
    """Give the complex weight at a frequency (rad/sample): linear between the rows, that of the end beyond them."""
    last = weights.shape[0] - 1
    place = np.searchsorted(weights[:, Weight.OMEGA], omega)
    if place == 0 or place > last:
        row = weights[0 if place == 0 else last]
        return complex(row[Weight.RE], row[Weight.IM])
    below, above = weights[place - 1], weights[place]
    part = (omega - below[Weight.OMEGA]) / (above[Weight.OMEGA] - below[Weight.OMEGA])
    return complex(
        below[Weight.RE] + part * (above[Weight.RE] - below[Weight.RE]),
        below[Weight.IM] + part * (above[Weight.IM] - below[Weight.IM]),
    )


@njit
def _response(design, correction, omega):
    return respond(design.b, design.a, omega) * factor(correction, omega)


@njit
def limit_volts(demand, limit):
    """Share the voltage limit among the amplitudes, small ones first; True where a tone gets less than it asks for."""
    volts, share = demand.volts, demand.share
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
def fade(settings, memory, demand, act):
    """Fade the tones' voltages in, or out at once, and give their sum (V)."""
    u = 0.0
    for i in range(memory.tones.shape[0]):
        t = memory.tones[i]
        t[Tone.BARRED] = max(t[Tone.BARRED] - 1.0, 0.0)
        if t[Tone.ON] == 0.0 or demand.volts[i] == 0.0:
            continue
        demand.inverse[i] *= demand.share[i]
        if act and t[Tone.PACE] > 0.0:
            paces = settings[Setting.PACE] * memory.backoff[Backoff.SLOW] ** 2
            t[Tone.FADE] = min(t[Tone.FADE] + FADE_IN / paces, 1.0)
        elif not act:
            t[Tone.FADE] = 0.0
        inverse = demand.inverse[i]
        u -= t[Tone.FADE] * (t[Tone.RE] * inverse.real - t[Tone.IM] * inverse.imag)
    return u


@njit
def note(demand, memory):
    """Write down for the back-off how large the voltage is."""
    tones, backoff = memory.tones, memory.backoff
    total, most = 0.0, 0.0
    for i in range(tones.shape[0]):
        total += demand.volts[i] * demand.share[i] * tones[i, Tone.FADE]
        if demand.volts[i] > 0.0:
            most = max(most, tones[i, Tone.FADE])
    backoff[Backoff.VOLTS] = total
    backoff[Backoff.FADED] = most
