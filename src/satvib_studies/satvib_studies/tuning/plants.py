# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The plants on which gains must prove themselves: the rig as it is, and the rig as it may turn out to be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from satvib_common.arrays import Array
from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.combined import Sum
from satvib_plant_sim.disturbance.mixer import Mixer
from satvib_plant_sim.disturbance.sine import Sine
from satvib_plant_sim.disturbance.tones import Tones
from satvib_plant_sim.physics.modes import modal_frequencies
from satvib_plant_sim.responses.continuous import frequency_response, source_transfer
from satvib_plant_sim.rig.random_rig import random_build
from satvib_plant_sim.rig.rig import Rig
from scipy.signal import welch

STREAM = 72
_SPACING = 0.25  # Hz


def perturbed(rig: Rig, count: int, seed: int) -> list[Rig]:
    """Give the rig, and `count` - 1 rigs that differ from it as rigs of one drawing do.

    They are those of `random_build`; plant i has the same numbers for any count.
    """
    draws = (np.random.default_rng([seed, STREAM, i]) for i in range(1, count))
    return [rig, *(random_build(rig, draw) for draw in draws)]


@dataclass(frozen=True)
class Spectrum:
    """Frequencies at which a loop is judged.

    Attributes:
        frequency: (f,) Hz, ascending.
        power: (f, 2) of the source's acceleration and of the force on the payload, (m/s^2)^2 and N^2.
        width: (f,) Hz, what a line stands for; 0 where there is only the margin to look at, or a pure tone.
    """

    frequency: Array
    power: Array
    width: Array


def spectrum_of(disturbance: Disturbance, rig: Rig, seed: int, duration: float) -> Spectrum:
    """Give the spectrum of a disturbance, and frequencies between that no margin is missed.

    Pure tones stand at their own frequencies; the rest is taken by Welch's method from `duration` s since its onset,
    as a mean when it changes with time. Lines are 0.25 Hz apart up to half the sample rate; below 3 Hz, where the
    integrators turn, and about the modes others are between them.
    """
    half = 0.5 * rig.acquisition.sample_rate
    tones: dict[float, Array] = {}
    rest = []
    for part in disturbance.parts():
        if not isinstance(part, Sine | Tones):
            rest.append(part)
            continue
        channel = int(part.target == 'payload')
        for tone in part.lines(partial(source_transfer, rig) if channel == 0 else _unity):
            f = tone.speed / (2.0 * math.pi)
            if f < half:
                tones.setdefault(f, np.zeros(2))[channel] += 0.5 * tone.amplitude * tone.amplitude
    lines = _SPACING * np.arange(1, math.ceil(half / _SPACING - 1e-9))
    extra = [np.geomspace(0.01, 3.0, 60), np.array(sorted(tones))]
    extra += [np.geomspace(0.7 * f, min(1.4 * f, 0.99 * half), 40) for f in modal_frequencies(rig)]
    grid = np.union1d(lines, np.concatenate(extra))
    power, width = np.zeros((len(grid), 2)), np.zeros(len(grid))
    at = np.searchsorted(grid, lines)
    width[at] = _SPACING
    if rest:
        power[at] = _welch(rest, rig, seed, duration, len(lines))
    for f, level in tones.items():
        power[np.searchsorted(grid, f)] += level
    return Spectrum(grid, power, width)


def _unity(_: float) -> float:
    return 1.0


def _welch(parts: Sequence[Disturbance], rig: Rig, seed: int, duration: float, lines: int) -> Array:
    """Power (lines, 2) of disturbances that are no tones."""
    period, n_fine = rig.acquisition.period, rig.acquisition.fine_steps
    whole = Sum(terms=tuple(parts))
    mixer = Mixer([whole], [seed], [partial(source_transfer, rig)], period / n_fine, n_fine)
    first = round(min(part.start for part in parts) / period)
    count = round(max(duration, 2.0 / _SPACING) / period)
    values = np.concatenate(
        [mixer.period(k)[0, :, :-1] for k in range(first, first + count)], axis=1
    )
    rate = n_fine / period
    _, density = welch(values, rate, 'hann', nperseg=round(rate / _SPACING), detrend=False)
    power = np.zeros((lines, 2))
    power[:, : len(values)] = (density * _SPACING)[:, 1 : lines + 1].T
    power[power < 1e-9 * power.max()] = 0.0
    return power


def gain_box(rig: Rig) -> tuple[Array, Array]:
    """Give the bounds (3, modes) of P, I, D in which a rig's gains are looked for.

    With w the mean of the payload's modes and b the acceleration per volt well above them, P up to 8 w / b (four times
    critical damping), I from -0.5 to 8 w^2 / b (a spring eight times the rig's), D from -0.5 to 1 / b (from half the
    mass less to twice the mass).
    """
    modes = modal_frequencies(rig)
    w = 2.0 * math.pi * float(np.mean(modes))
    b = float(abs(frequency_response(rig, 5.0 * float(np.mean(modes)))[0, 0]))
    n = rig.struts.count
    low = np.array([0.0, -0.5 * w * w / b, -0.5 / b])
    high = np.array([8.0 * w / b, 8.0 * w * w / b, 1.0 / b])
    return np.repeat(low[:, None], n, axis=1), np.repeat(high[:, None], n, axis=1)
