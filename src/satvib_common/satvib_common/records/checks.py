# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is odd about a measured signal, in one line each with its share: nothing is repaired.

Offset, clipping, stuck values, outliers, drift, whole numbers and coarse steps. A signal of few levels (a square wave,
a PRBS) is at its limits and holds its values by design, so those two are looked for only in signals of many levels.
"""

import numpy as np

from satvib_common.arrays import Array, Integers

OFFSET = 3.0  # deviations from zero
LEVELS = 10  # up to so many values are a design
CLIPPED = 5.0  # times as many samples at the limit as at the level beside it
CLIPPED_SHARE = 0.005
STUCK = 10  # samples of one value after the other, and 20 times what is usual
OUTLIER = 12.0  # robust deviations of the second difference
DRIFT = 0.5  # share of the variance that is a straight line
COARSE = 0.1  # step in deviations


def check_signal(name: str, values: Array) -> list[str]:
    """Look at a signal.

    Args:
        name: 'input' or 'output', for the lines.
        values: (samples) NaN where missing.

    Returns:
        A line for each thing that is odd.
    """
    x = values[np.isfinite(values)]
    if len(x) < 20:
        return []
    peak = float(np.max(np.abs(x)))
    if not peak > 0.0:
        return []
    x = x / peak
    deviation = float(np.std(x))
    if not deviation > 1e-14:
        return []
    said = []
    mean = float(np.mean(x))
    if abs(mean) > OFFSET * deviation:
        said.append(
            f'{name}: its mean, {mean * peak:.6g}, is {abs(mean) / deviation:.3g} times its deviation: an offset'
        )
    levels, counts = np.unique(x, return_counts=True)
    if len(levels) > LEVELS:
        said += _clipping(name, x, levels, counts, peak)
        said += _stuck(name, x)
        said += _outliers(name, x, deviation)
        said += _steps(name, x * peak, levels, deviation, peak)
    said += _drift(name, x)
    return said


def _clipping(name: str, x: Array, levels: Array, counts: Integers, peak: float) -> list[str]:
    said = []
    for edge, beside, what in ((-1, slice(-4, -1), 'largest'), (0, slice(1, 4), 'smallest')):
        share = counts[edge] / len(x)
        at_edge = x == levels[edge]
        together = np.any(at_edge[1:] & at_edge[:-1])
        if (
            counts[edge] >= 5
            and share >= CLIPPED_SHARE
            and together
            and counts[edge] > CLIPPED * counts[beside].max()
        ):
            said.append(
                f'{name}: {100.0 * share:.2g} % of the samples are at its {what} value, {levels[edge] * peak:.6g}: '
                'probably clipped'
            )
    return said


def _runs(x: Array) -> Array:
    """Lengths of runs of one value."""
    ends = np.flatnonzero(np.diff(x) != 0.0)
    return np.diff(np.concatenate([[-1], ends, [len(x) - 1]]))


def _stuck(name: str, x: Array) -> list[str]:
    runs = _runs(x)
    long = runs[runs >= max(STUCK, 20.0 * float(np.median(runs)))]
    inner = runs[1:-1]
    if not len(long) or not np.any(inner >= STUCK):
        return []
    return [
        (
            f'{name}: holds one value for up to {int(long.max())} samples, {100.0 * long.sum() / len(x):.2g} % in such '
            'stretches: a stuck sensor or no new data'
        )
    ]


def _outliers(name: str, x: Array, deviation: float) -> list[str]:
    bend = x[1:-1] - 0.5 * (x[2:] + x[:-2])
    usual = 1.4826 * float(np.median(np.abs(bend - np.median(bend))))
    alone = np.abs(bend) > max(OUTLIER * usual, 0.5 * min(deviation, 1.4826 * _spread(x)))
    alone &= (np.abs(bend) > 1.5 * np.abs(np.roll(bend, 1))) & (
        np.abs(bend) > 1.5 * np.abs(np.roll(bend, -1))
    )
    count = int(alone.sum())
    if not count or count > 0.02 * len(x) or not usual > 0.0:
        return []
    return [
        (
            f'{name}: {count} samples ({100.0 * count / len(x):.2g} %) stand apart from both neighbours: outliers, '
            'which spoil least squares'
        )
    ]


def _spread(x: Array) -> float:
    return float(np.median(np.abs(x - np.median(x)))) or float(np.std(x))


def _drift(name: str, x: Array) -> list[str]:
    k = np.linspace(-0.5, 0.5, len(x))
    slope = float(k @ x) / float(k @ k)
    share = 1.0 - float(np.var(x - slope * k)) / float(np.var(x))
    if share <= DRIFT:
        return []
    return [
        f'{name}: drifts; a straight line is {100.0 * share:.0f} % of its variance: take the trend off'
    ]


def _steps(name: str, x: Array, levels: Array, deviation: float, peak: float) -> list[str]:
    if np.array_equal(x, np.rint(x)) and deviation * peak < 30.0:
        return [f'{name}: all values are whole numbers: were the decimals lost?']
    step = float(np.min(np.diff(levels)))
    if step > COARSE * deviation:
        return [
            f'{name}: moves in steps of {step * peak:.3g}, {100.0 * step / deviation:.0f} % of its deviation'
        ]
    return []
