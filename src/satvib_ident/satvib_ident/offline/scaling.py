# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A record in units of its own size, so that a model does not depend on the units of its signals.

Every signal is taken relative to the mean of the part that models are estimated from, in units of the power of two next
to its deviation: no bit is lost, and a record in other units gives the same model.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError


@dataclass(frozen=True, eq=False)
class Scaled:
    """A signal in its own unit, x = centre + unit * values.

    Attributes:
        values: (samples) NaN where missing.
        centre: mean over the part that is estimated from.
        unit: a power of two.
    """

    values: Array
    centre: float
    unit: float


def check_record(y: ArrayLike, u: ArrayLike) -> tuple[Array, Array]:
    """Give a record as two arrays of floats; NaN marks a missing sample.

    Raises:
        SatvibError: not numbers, of different lengths, with infinite values, without values, or a signal that never
            changes.
    """
    try:
        out, drive = np.asarray(y, dtype=float), np.asarray(u, dtype=float)
    except (TypeError, ValueError) as error:
        raise SatvibError(f'record: not numbers: {error}') from None
    if out.ndim != 1 or out.shape != drive.shape:
        raise SatvibError(f'record: output {out.shape} and input {drive.shape} differ in shape')
    for name, values in (('output', out), ('input', drive)):
        bad = np.flatnonzero(np.isinf(values))
        if bad.size:
            raise SatvibError(
                f'record: {name}: sample {bad[0]} is {values[bad[0]]}, as are {bad.size - 1} more; '
                'cut or repair the record'
            )
        known = values[np.isfinite(values)]
        if not known.size:
            raise SatvibError(f'record: {name}: no sample is known')
        if np.ptp(known / (np.max(np.abs(known)) or 1.0)) == 0.0:
            raise SatvibError(f'record: {name}: never changes, so nothing follows from it')
    return out, drive


def scale(values: Array, part: slice) -> Scaled:
    """Express a signal (samples) in its own unit, relative to its mean over `part`."""
    known = values[np.isfinite(values)]
    largest = math.frexp(float(np.max(np.abs(known))))[1]
    small = np.ldexp(values, -largest)  # squares of this neither overflow nor vanish
    of_part = small[part][np.isfinite(small[part])]
    centre = float(np.mean(of_part)) if of_part.size else 0.0
    known = small[np.isfinite(small)] - centre
    spread = math.frexp(float(np.sqrt(np.mean(known * known))))[1] - 1
    return Scaled(
        np.ldexp(small - centre, -spread),
        math.ldexp(centre, largest),
        math.ldexp(1.0, largest + spread),
    )
