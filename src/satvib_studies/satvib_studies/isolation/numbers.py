# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of a judgement: peaks, isolation, roll-off and amplification of a law, seed by seed."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from satvib_common.arrays import Array
from satvib_experiment.frf.curve import Curve
from satvib_experiment.frf.merit import TRUSTED, merit_of, roll_off

HEAVE = 'heave'
_NAN = float('nan')


@dataclass(frozen=True)
class Judged:
    """Figures of a law on one seed, or (seeds,) arrays of them; NaN where the measurement does not show one.

    Attributes:
        peak, peak_at: dB and Hz, of heave.
        strut_peak, strut_at: of the worst strut.
        tilt_peak: dB, of the worst tilt, at the circle or the mean distance of the struts, per heave of the base.
        isolation_from: Hz, above it the payload heaves less than the base.
        roll_off: dB per decade, of heave, in the band that is stated.
        worse, worse_at: dB and Hz: the largest heave over that of the open loop.
        coherence: median over the lines, of heave.
    """

    peak: float | Array
    peak_at: float | Array
    strut_peak: float | Array
    strut_at: float | Array
    tilt_peak: float | Array
    isolation_from: float | Array
    roll_off: float | Array
    worse: float | Array
    worse_at: float | Array
    coherence: float | Array


def judged_seed(curves: Sequence[Curve], still: Sequence[Curve], band: tuple[float, ...]) -> Judged:
    """Judge the curves of one seed.

    Args:
        curves: of a law.
        still: of the open loop, with the same seed.
        band: Hz, of the roll-off.
    """
    heave, quiet = (next(c for c in group if c.output == HEAVE) for group in (curves, still))
    merit = merit_of(heave.measured)
    struts = [merit_of(c.measured) for c in curves if c.output.startswith('strut')]
    worst = max((m for m in struts if m), key=lambda m: m.peak, default=None)
    tilts = [merit_of(c.measured) for c in curves if c.output.startswith('tilt')]
    worse, at = _worse(heave, quiet)
    slope = roll_off(heave.measured, *band)
    return Judged(
        peak=merit.peak if merit else _NAN,
        peak_at=merit.peak_frequency if merit else _NAN,
        strut_peak=worst.peak if worst else _NAN,
        strut_at=worst.peak_frequency if worst else _NAN,
        tilt_peak=max((m.peak for m in tilts if m), default=_NAN),
        isolation_from=_NAN
        if merit is None or merit.isolation_from is None
        else merit.isolation_from,
        roll_off=_NAN if slope is None else slope[0],
        worse=worse,
        worse_at=at,
        coherence=merit.coherence if merit else _NAN,
    )


def _worse(mine: Curve, still: Curve) -> tuple[float, float]:
    """Largest response over that of the open loop where both are coherent, dB, and its frequency, Hz."""
    a, b = mine.measured, still.measured
    sure = (a.coherence >= TRUSTED) & (b.coherence >= TRUSTED)
    if not sure.any():
        return _NAN, _NAN
    gain = np.where(sure, a.decibels - b.decibels, -np.inf)
    at = int(np.argmax(gain))
    return float(gain[at]), float(a.frequency[at])


def judged(
    curves: Sequence[Sequence[Curve]], still: Sequence[Sequence[Curve]], band: tuple[float, ...]
) -> Judged:
    """Judge all seeds; every figure is an array (seeds,)."""
    rows = [judged_seed(mine, open_, band) for mine, open_ in zip(curves, still, strict=True)]
    return Judged(
        **{f.name: np.array([getattr(row, f.name) for row in rows]) for f in fields(Judged)}
    )
