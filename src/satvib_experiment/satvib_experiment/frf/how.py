# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which estimator fits what moved: periods of a multisine, steps of a sine, the whole of a sweep, else averages."""

import math
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_ident.excitation.chirp import Chirp
from satvib_ident.excitation.periodic import PeriodicExcitation
from satvib_ident.frequency.averaged import averaged_response
from satvib_ident.frequency.local import local_response
from satvib_ident.frequency.periodic import periodic_response, stepped_response
from satvib_ident.frequency.response import FrequencyResponse
from satvib_ident.frequency.settings import FrfSettings
from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.random import Random
from satvib_plant_sim.disturbance.reaction_wheel import ReactionWheel
from satvib_plant_sim.disturbance.sweep import SteppedSine, Sweep
from satvib_plant_sim.disturbance.tones import Multisine

from satvib_experiment.frf.lines import measuring_lines

_SETTLED = 0.5  # share of a step after which its steady state begins
_INSIDE = 0.9  # share of the band of a sweep that is used, at either end
_ENOUGH = 3  # periods that make a record periodic
_HEARD = 1e-3  # lines of the input below this share of its strongest power are not excited


@dataclass(frozen=True)
class Moved:
    """What moved in a stretch of a record.

    Attributes:
        low, high: Hz, edges of the band; 0 and infinity: found from the input.
        period: samples after which it repeats; 0: it does not.
        steps: of a stepped sine: frequency in Hz, start and end in samples of the stretch.
        whole: a sweep or another transient that the stretch holds as a whole.
    """

    low: float = 0.0
    high: float = math.inf
    period: int = 0
    steps: tuple[tuple[float, int, int], ...] = ()
    whole: bool = False


def moved_by(disturbance: Disturbance, start: float, end: float, dt: float) -> Moved:
    """Find out what a disturbance does from `start` to `end`, s since sample 0; `dt` in s."""
    low, high, found, whole = math.inf, 0.0, False, True
    for part in disturbance.parts():
        if part.start >= end or (part.stop is not None and part.stop <= start):
            continue
        if isinstance(part, SteppedSine):
            return Moved(steps=_steps(part, start, end, dt))
        band = _band(part)
        if band is None:
            return Moved()
        if isinstance(part, Multisine) and len(disturbance.parts()) == 1:
            return Moved(*band, period=round(part.period / dt))
        low, high, found = min(low, band[0]), max(high, band[1]), True
        whole = whole and isinstance(part, Sweep)
    return Moved(low, high, whole=whole) if found else Moved()


def base_directions(disturbance: Disturbance, start: float, end: float) -> list[tuple[float, ...]]:
    """Give the directions in which the base is moved from `start` to `end`, s, each once.

    They are factors along and about x, y, z. Each has the length 1, metres and radians alike, and its first factor
    that is not 0 is positive.
    """
    found: list[Array] = []
    for part in disturbance.parts():
        if part.target != 'base' or part.start >= end or (part.stop or math.inf) <= start:
            continue
        given = np.array(part.weights(6))
        given = given / (np.linalg.norm(given) * np.sign(given[np.flatnonzero(given)[0]]))
        if not any(np.allclose(given, other, atol=1e-9) for other in found):
            found.append(given)
    return [tuple(float(v) for v in given) for given in found]


def _band(part: Disturbance) -> tuple[float, float] | None:
    """Edges of the band of a disturbance, Hz; None for one whose band is not a matter of its settings."""
    if isinstance(part, Multisine | Random):
        return part.low, part.high
    if isinstance(part, Sweep):
        return min(part.frequency, part.end_frequency), max(part.frequency, part.end_frequency)
    if isinstance(part, ReactionWheel) and part.end_speed is not None:
        slow, fast = sorted((part.speed, part.end_speed))
        return slow * min(part.harmonics), fast * max(part.harmonics)
    return None


def _steps(part: SteppedSine, start: float, end: float, dt: float) -> tuple[tuple[float, int, int], ...]:  # fmt: skip
    found = []
    for i, f in enumerate(part.frequencies()):
        begins = part.start + (i + _SETTLED) * part.dwell
        ends = part.start + (i + 1) * part.dwell
        if begins >= start and ends <= end + dt:
            found.append((f, math.ceil((begins - start) / dt), math.floor((ends - start) / dt)))
    return tuple(found)


def moved_by_excitation(signal: object) -> Moved:
    """Find out what an excitation of `satvib_ident.excitation` does."""
    low, high = getattr(signal, 'low', 0.0), getattr(signal, 'high', math.inf)
    period = signal.count if isinstance(signal, PeriodicExcitation) else 0
    return Moved(min(low, high), max(low, high), period, whole=isinstance(signal, Chirp))


def estimate(
    x: Array, y: Array, dt: float, moved: Moved, settings: FrfSettings
) -> FrequencyResponse:
    """Estimate the response from x to y, (..., t) each, with what fits.

    Raises:
        OnlyTones: the input moves at a few frequencies, and nothing says that it is a stepped sine.
        SatvibError: the record is too short, or the input does not move.
    """
    if moved.steps:
        steps = [s for s in moved.steps if s[2] <= x.shape[-1]]
        if not steps:
            raise SatvibError('the stretch holds no whole step of the stepped sine')
        return stepped_response(x, y, dt, steps, confidence=settings.confidence)
    asked = settings.resolution or settings.averages
    if moved.whole and not asked and np.isfinite(x).all() and np.isfinite(y).all():
        # a sweep that begins and stops at once says little about its own ends
        found = local_response(x, y, dt, settings.confidence, rest=True)
        return _between(found, moved.low / _INSIDE, moved.high * _INSIDE)
    if moved.period and x.shape[-1] >= _ENOUGH * moved.period and not asked:
        found = periodic_response(x, y, dt, moved.period, settings.confidence)
        return _between(found, moved.low, moved.high)
    found = averaged_response(x, y, dt, settings)
    if moved.low > 0.0:
        return _between(found, moved.low, moved.high)
    return measuring_lines(found, x, dt, settings)


def _between(found: FrequencyResponse, low: float, high: float) -> FrequencyResponse:
    kept = found.between(low, high)
    if not kept.frequency.size:
        raise SatvibError(
            f'no line of the estimate ({found.method}) lies between {low:.4g} and {high:.4g} Hz: the band is too narrow'
        )
    return kept


def period_samples(period: float, dt: float) -> int:
    """Give the samples of a period in s.

    Raises:
        SatvibError: it is no whole number of samples, or fewer than three, which have no line.
    """
    samples = round(period / dt)
    if samples < 3 or abs(samples * dt - period) > 1e-3 * dt * samples:
        raise SatvibError(
            f'--period: {period:g} s is no whole number of samples of {dt:g} s, of three at least'
        )
    return samples


def heard(x: Array, dt: float, settings: FrfSettings) -> tuple[float, float]:
    """Give the edges of the band in which a signal (..., t) has more than a thousandth of its strongest power, Hz."""
    from satvib_ident.frequency.spectra import averaged_spectra

    found = averaged_spectra(x[..., None, :], dt, settings)
    power = found.matrix[..., 0, 0].real
    power = power.reshape(-1, power.shape[-1]).max(axis=0)
    lines = np.flatnonzero(power >= _HEARD * power.max())
    return float(found.frequency[lines[0]]), float(found.frequency[lines[-1]])
