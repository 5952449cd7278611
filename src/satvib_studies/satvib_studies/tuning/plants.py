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
from satvib_plant_sim.disturbance.base import Clock, Disturbance, Transfer
from satvib_plant_sim.disturbance.sine import Sine
from satvib_plant_sim.disturbance.tones import Tones
from satvib_plant_sim.physics.modes import modal_frequencies
from satvib_plant_sim.physics.state import size_of
from satvib_plant_sim.responses.continuous import frequency_response, source_transfer
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.random_rig import random_build
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.rig.streams import Stream
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
        power: (f, e) of each source, (m/s^2)^2 or N^2. Under struts on a circle these are the acceleration of the
            base and the force on the payload; listed struts have one for each direction in which the disturbance acts.
            Sources add up as if nothing tied them together.
        sources: (e, directions) the factors of each source in the directions of base and payload.
        width: (f,) Hz, what a line stands for; 0 where there is only the margin to look at, or a pure tone.
    """

    frequency: Array
    power: Array
    sources: Array
    width: Array


def spectrum_of(
    disturbance: Disturbance, rig: Rig, seed: int, duration: float, more: Sequence[float] = ()
) -> Spectrum:
    """Give the spectrum of a disturbance, and frequencies between that no margin is missed.

    Pure tones stand at their own frequencies; the rest is taken by Welch's method from `duration` s since its onset,
    as a mean when it changes with time. Lines are 0.25 Hz apart up to half the sample rate; below 3 Hz, where the
    integrators turn, about the modes and at `more` (Hz) others are between them.
    """
    half = 0.5 * rig.acquisition.sample_rate
    tones: dict[float, Array] = {}
    sources = _sources(disturbance, rig)
    count = len(sources)
    rest: list[tuple[int, float, Disturbance]] = []
    for part in disturbance.parts():
        factors, scale = _source(part, rig)
        source = sources.index(factors)
        if not isinstance(part, Sine | Tones):
            rest.append((source, scale, part))
            continue
        for tone in part.lines(_transfer(part, rig)):
            f = tone.speed / (2.0 * math.pi)
            if f < half:
                tones.setdefault(f, np.zeros(count))[source] += (
                    scale * 0.5 * tone.amplitude * tone.amplitude
                )
    lines = _SPACING * np.arange(1, math.ceil(half / _SPACING - 1e-9))
    extra = [np.geomspace(0.01, 3.0, 60), np.array(sorted(tones))]
    extra += [np.geomspace(0.7 * f, min(1.4 * f, 0.99 * half), 40) for f in modal_frequencies(rig)]
    extra.append(np.array([f for f in more if 0.0 < f < half]))
    grid = np.union1d(lines, np.concatenate(extra))
    power, width = np.zeros((len(grid), count)), np.zeros(len(grid))
    at = np.searchsorted(grid, lines)
    width[at] = _SPACING
    if rest:
        power[at] = _welch(rest, count, rig, seed, duration, len(lines))
    for f, level in tones.items():
        power[np.searchsorted(grid, f)] += level
    return Spectrum(grid, power, np.array(sources), width)


_Source = tuple[float, ...]


def _source(part: Disturbance, rig: Rig) -> tuple[_Source, float]:
    """Give the factors of a disturbance in the directions of base and payload, and what its power counts.

    Where base and payload have one direction each, the factor is 1 and the power has its square.
    """
    _, base, payload = size_of(rig)
    own = part.weights(payload if part.target == 'payload' else base)
    scale = 1.0
    if len(own) == 1:
        own, scale = (1.0,), own[0] * own[0]
    if part.target == 'payload':
        return (*(0.0,) * base, *own), scale
    return (*own, *(0.0,) * payload), scale


def _sources(disturbance: Disturbance, rig: Rig) -> list[_Source]:
    """Give the sources: base and payload where each has one direction, else what the disturbance has."""
    if not rig.struts.each:
        return [(1.0, 0.0), (0.0, 1.0)]
    found = [_source(part, rig)[0] for part in disturbance.parts()]
    return list(dict.fromkeys(found)) or [(0.0,) * 12]


def _transfer(part: Disturbance, rig: Rig) -> Transfer:
    """Give the transfer from the source to the lower plate along a disturbance; 1 for one that acts on the payload."""
    if part.target == 'payload':
        return _unity
    if not rig.struts.each:
        return partial(source_transfer, rig)
    return partial(source_transfer, rig, direction=part.weights(6))


def _unity(_: float) -> float:
    return 1.0


def _welch(
    rest: Sequence[tuple[int, float, Disturbance]], sources: int, rig: Rig, seed: int,
    duration: float, lines: int,
) -> Array:  # fmt: skip
    """Power (lines, sources) of disturbances that are no tones; each with its source and what its power counts."""
    period, n_fine = rig.acquisition.period, rig.acquisition.fine_steps
    first = round(min(part.start for _, _, part in rest) / period)
    count = round(max(duration, 2.0 / _SPACING) / period)
    values = np.zeros((sources, count * n_fine))
    clock, grid = Clock(period / n_fine), np.arange(n_fine, dtype=float)
    for order, (source, scale, part) in enumerate(rest):
        seeds = [(seed, Stream.DISTURBANCE, order)]
        bank = type(part).bank([part], seeds, clock, [_transfer(part, rig)])
        series = [bank.evaluate(k * n_fine, grid)[0] for k in range(first, first + count)]
        values[source] += math.sqrt(scale) * np.concatenate(series)
    rate = n_fine / period
    _, density = welch(values, rate, 'hann', nperseg=round(rate / _SPACING), detrend=False)
    power = np.asarray((density * _SPACING)[:, 1 : lines + 1].T).copy()
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
    n = len(payload_modes(rig).names)
    low = np.array([0.0, -0.5 * w * w / b, -0.5 / b])
    high = np.array([8.0 * w / b, 8.0 * w * w / b, 1.0 / b])
    return np.repeat(low[:, None], n, axis=1), np.repeat(high[:, None], n, axis=1)
