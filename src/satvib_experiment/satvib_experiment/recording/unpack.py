# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a graph leaves out of a bag to save time, put back: blocks of truth, and states that did not change."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError

_EACH = ('stroke', 'stroke_peak', 'force_peak', 'current')


@dataclass(frozen=True)
class TruthSample:
    """A satvib_msgs/StrutTruth of one sample."""

    sequence: int
    fine_period: float
    upper: Array
    lower: Array
    stroke: float
    stroke_peak: float
    force_peak: float
    current: float


def truth_samples(block: Any) -> list[TruthSample]:
    """Give every sample of a satvib_msgs/StrutTruth that holds several.

    Raises:
        SatvibError: its lists do not fit its number of samples.
    """
    count = int(block.samples)
    figures = [getattr(block, f'{name}s') for name in _EACH]
    plates = (block.upper, block.lower)
    if any(len(values) != count for values in figures) or any(len(p) % count for p in plates):
        raise SatvibError(f'damaged: truth of {count} samples with lists of other lengths')
    upper, lower = (np.reshape(values, (count, -1)) for values in plates)
    return [
        TruthSample(
            block.sequence + i, block.fine_period, upper[i], lower[i],
            *(float(values[i]) for values in figures),
        )
        for i in range(count)
    ]  # fmt: skip


def hold(group: dict[str, NDArray[Any]]) -> None:
    """Let every figure (samples, struts, ...) of a group stay until the next message; `present` stays as it is."""
    present = group['present']
    rows = np.where(present, np.arange(len(present))[:, None], 0)
    newest = np.maximum.accumulate(rows, axis=0)
    columns = np.arange(present.shape[1])
    for name, values in group.items():
        if name != 'present':
            group[name] = values[newest, columns]
