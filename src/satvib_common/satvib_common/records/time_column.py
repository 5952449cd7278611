# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a time column says: the sample period, and where samples are missing, repeated or out of order.

Steps of the time are compared with multiples of the sample period. Where samples are missing, their places stay empty,
so that no regression vector reaches over them. Where the time jumps by an unknown number of samples, or goes back
because two records were glued, more places stay empty than a model can remember.
"""

import re
from dataclasses import dataclass, field

import numpy as np

from satvib_common.arrays import Array, Integers
from satvib_common.errors import SatvibError

JITTER_SAID = 0.01  # of a period, RMS
JITTER = 0.3  # of a period: a step that is this far from every multiple is irregular
IRREGULAR = 0.1  # share of irregular steps from which on there is no sample period
GAPS = 0.25  # share of steps with missing samples from which on a record is refused
LONGEST_GAP = 30  # samples that are kept empty one by one
MOST_BACK = 10  # or 1 % of the rows: steps back in time, more is no order at all
_UNITS = {
    'ns': 1e-9, 'us': 1e-6, 'µs': 1e-6, 'μs': 1e-6, 'ms': 1e-3, 's': 1.0, 'sec': 1.0, 'secs': 1.0, 'seconds': 1.0,
    'min': 60.0, 'h': 3600.0,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Places:
    """Where the rows of a record belong.

    Attributes:
        period: in the unit of the time column; 0 where it is not known.
        place: (rows) index of each row in the record with its gaps; -1: the row is left out.
        size: samples of the record with its gaps.
        notes: what was found.
    """

    period: float
    place: Integers
    size: int
    notes: list[str] = field(default_factory=list)


def unit_of(name: str) -> float | None:
    """Unit in the name of a time column, s; None where there is none."""
    found = re.search(
        r'[\[\(/_ ]\s*(ns|us|µs|μs|ms|s|secs?|seconds|min|h)[\]\)]?$', name.strip(), re.IGNORECASE
    )
    if found:
        return _UNITS[found[1].lower()]
    return 1.0 if name.strip().lower() == 'seconds' else None


def in_order(rows: int) -> Places:
    """One sample a row."""
    return Places(0.0, np.arange(rows), rows)


def places(
    time: Array, values: Array, lines: Array, unknown: int, name: str, row: str = 'line'
) -> Places:
    """Find where the rows belong.

    Args:
        time: (rows) NaN where not known.
        values: (columns, rows) of the signals; rows that repeat time and values are left out.
        lines: (rows) numbers of the rows, for messages.
        unknown: samples that stay empty where an unknown number is missing.
        name: of the column, for messages.
        row: what `lines` counts, for messages.

    Raises:
        SatvibError: the time runs backward, has no period, or too many samples are missing.
    """
    known = np.flatnonzero(np.isfinite(time))
    notes: list[str] = []
    if len(known) < 3:
        raise SatvibError(f'time column {name!r}: fewer than three times')
    if lost := len(time) - len(known):
        notes.append(f'{lost} rows without a time are left out')
    t = time[known]
    steps = np.diff(t)
    if not np.any(steps > 0.0):
        raise SatvibError(f'time column {name!r}: never goes forward; sort the rows by time')
    if np.median(steps) < 0.0:
        raise SatvibError(f'time column {name!r}: runs backward; sort the rows by time')
    coarse = _rounded(t, steps)
    if coarse is not None:
        resolution, period = coarse
        notes.append(
            f'the time is rounded to {resolution:.4g}, which is more than the sample period; samples are taken '
            'as evenly '
            'spaced'
        )
        out = np.full(len(time), -1)
        out[known] = np.arange(len(known))
        return Places(period, out, len(known), notes)
    repeated = np.zeros(len(t), dtype=bool)
    same_time = np.flatnonzero(steps == 0.0) + 1
    doubtful = 0
    for i in same_time:
        repeated[i] = True
        if not np.array_equal(values[:, known[i]], values[:, known[i - 1]], equal_nan=True):
            doubtful += 1
    if len(same_time):
        notes.append(
            f'{len(same_time)} rows repeat the time of the row before ({_share(len(same_time), len(t))}, first at '
            f'{row} {int(lines[known[same_time[0]]])}), {doubtful} of them with other values; the first of each is used'
        )
        if doubtful > max(3, 0.05 * len(t)):
            raise SatvibError(
                f'time column {name!r}: {doubtful} rows have the time of the row before and other values, '
                'first at {row} '
                f'{int(lines[known[same_time[0]]])}; which one counts cannot be told'
            )
    known, t = known[~repeated], t[~repeated]
    return _placed(len(time), known, t, lines, unknown, name, notes, row)


def _placed(
    rows: int,
    known: Integers,
    t: Array,
    lines: Array,
    unknown: int,
    name: str,
    notes: list[str],
    row: str,
) -> Places:
    steps = np.diff(t)
    back = steps < 0.0
    if back.sum() > max(MOST_BACK, 0.01 * len(t)):
        raise SatvibError(
            f'time column {name!r}: goes back {int(back.sum())} times, first at {row} '
            f'{int(lines[known[1:][back][0]])}; sort the rows by time'
        )
    period = _period(steps[~back])
    ratio = steps / period
    multiple = np.maximum(np.rint(np.clip(ratio, 0.0, 1e9)), 1.0)
    irregular = ~back & (np.abs(ratio - multiple) > JITTER) & (ratio < LONGEST_GAP)
    if irregular.sum() > IRREGULAR * len(steps):
        raise SatvibError(
            f'time column {name!r}: {_share(int(irregular.sum()), len(steps))} of the steps are no multiple of '
            f'{period:.6g}; resample the record to one sample period'
        )
    missing = ~back & (multiple > 1.0)
    if missing.sum() > GAPS * len(steps):
        raise SatvibError(
            f'time column {name!r}: samples are missing after {_share(int(missing.sum()), len(steps))} of the '
            'rows, too '
            'many for a model; the sample period changes, or the recording lost data'
        )
    regular = ~back & ~missing
    jitter = float(np.sqrt(np.mean((ratio[regular] - 1.0) ** 2))) if regular.any() else 0.0
    if jitter > JITTER_SAID:
        notes.append(f'the time varies by {100.0 * jitter:.1f} % of the sample period (RMS)')
    unsure = back | (missing & ((multiple > LONGEST_GAP) | (np.abs(ratio - multiple) > JITTER)))
    step = np.where(unsure, unknown + 1, multiple).astype(np.int64)
    if gaps := int((missing & ~unsure).sum()):
        sizes = multiple[missing & ~unsure] - 1.0
        first = int(lines[known[1:][missing & ~unsure][0]])
        notes.append(
            f'the time jumps over missing samples at {gaps} places ({int(sizes.sum())} samples, '
            f'{_share(int(sizes.sum()), len(t) + int(sizes.sum()))}; first before {row} {first}); nothing is '
            'taken across '
            'a gap'
        )
    for i in np.flatnonzero(unsure)[:3]:
        what = 'goes back' if back[i] else 'jumps'
        notes.append(
            f'the time {what} from {t[i]:.6g} to {t[i + 1]:.6g} at {row} {int(lines[known[i + 1]])}: what '
            'follows is taken '
            'as a record of its own'
        )
    if (more := int(unsure.sum()) - 3) > 0:
        notes.append(f'and so at {more} more places')
    out = np.full(rows, -1)
    out[known] = np.concatenate([[0], np.cumsum(step)])
    return Places(period, out, int(out.max()) + 1, notes)


def _rounded(t: Array, steps: Array) -> tuple[float, float] | None:
    """Resolution and period of a time that was rounded to more than its period; None for any other."""
    if np.mean(steps == 0.0) < 0.05 or np.any(steps < 0.0):
        return None
    resolution = float(steps[steps > 0.0].min())
    period = float(t[-1] - t[0]) / len(steps)
    even = np.arange(len(t)) * period
    if resolution < 0.9 * period or np.max(np.abs(t - t[0] - even)) > 1.01 * resolution + period:
        return None
    return resolution, period


def _period(steps: Array) -> float:
    """The period of which most steps are multiples: from the median and from the mean, the one that fits better."""
    positive = steps[steps > 0.0]
    found = []
    for start in (float(np.median(positive)), float(np.mean(positive))):
        period = start
        for _ in range(5):
            multiple = np.rint(positive / period)
            near = (multiple >= 1.0) & (multiple <= LONGEST_GAP)
            if not near.any():
                break
            period = float(positive[near].sum() / multiple[near].sum())
        off = np.abs(positive / period - np.maximum(np.rint(positive / period), 1.0))
        gaps = float(np.mean(positive > 1.5 * period))
        found.append((round(float(np.quantile(off, 0.9)), 2), gaps, period))
    return min(found)[2]


def _share(part: int, whole: int) -> str:
    return f'{100.0 * part / max(whole, 1):.2g} %'
