# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which parameters a figure depends on: correlation ratio and rank correlation.

Correlation ratio (Pearson 1905), the share of a figure's variance that one parameter explains alone, whatever the shape
of the dependence; with the values of the parameter in K groups of equal size n_g,

    eta^2 = sum_g n_g (mean_g - mean)^2 / sum_i (y_i - mean)^2,   eps^2 = 1 - (1 - eta^2) (N - 1) / (N - K)

eps^2 (Kelley 1935) has the share taken off that chance would give. It estimates the first-order Sobol index where the
parameters are independent, as in a campaign. Spearman's rank correlation adds the direction.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array
from scipy.stats import rankdata

_SMALLEST = 8  # values of a group


@dataclass(frozen=True)
class Sensitivity:
    """One parameter's weight.

    Attributes:
        key: of the parameter.
        share: eps^2, part of the variance, 0 to 1.
        rank: Spearman's correlation, -1 to 1; NaN for what has no order.
    """

    key: str
    share: float
    rank: float


def groups_of(values: Sequence[Any]) -> NDArray[np.intp]:
    """Give the group (n) of every value: its own for few different values, else one of equal size."""
    unique, inverse = np.unique(np.asarray(values), return_inverse=True)
    count = len(values)
    most = max(min(round(np.sqrt(count / 2.0)), 32, count // _SMALLEST), 1)
    if len(unique) <= max(most, 2):
        return np.asarray(inverse)
    order = np.argsort(np.asarray(values), kind='stable')
    groups = np.empty(count, dtype=np.intp)
    groups[order] = np.arange(count) * most // count
    return groups


def correlation_ratio(values: Sequence[Any], figure: Array) -> float:
    """Give eps^2 of a figure (n) by one parameter's values (n), not below 0; NaN with too few trials."""
    groups = groups_of(values)
    total, k = len(figure), int(groups.max()) + 1 if len(groups) else 0
    spread = float(np.sum((figure - figure.mean()) ** 2)) if total else 0.0
    if total <= k or k < 2 or spread == 0.0:
        return 0.0 if total > k and spread == 0.0 else float('nan')
    counts = np.bincount(groups, minlength=k)
    means = np.bincount(groups, weights=figure, minlength=k) / np.maximum(counts, 1)
    between = float(np.sum(counts * (means - figure.mean()) ** 2))
    return max(1.0 - (1.0 - between / spread) * (total - 1) / (total - k), 0.0)


def rank_correlation(values: Sequence[Any], figure: Array) -> float:
    """Give Spearman's correlation; NaN where a side is constant or not of numbers."""
    x = np.asarray(values)
    if x.dtype.kind not in 'if' or len(x) < 3 or np.ptp(x) == 0.0 or np.ptp(figure) == 0.0:
        return float('nan')
    return float(np.corrcoef(rankdata(x), rankdata(figure))[0, 1])


def ranking(
    parameters: Mapping[str, Sequence[Any] | NDArray[Any]], figure: Array
) -> list[Sensitivity]:
    """Rank parameters by their share; trials without the figure (NaN) are left out."""
    good = np.isfinite(figure)
    found = []
    for key, values in parameters.items():
        chosen = np.asarray(values)[good]
        found.append(
            Sensitivity(
                key,
                correlation_ratio(chosen.tolist(), figure[good]),
                rank_correlation(chosen.tolist(), figure[good]),
            )
        )
    return sorted(found, key=lambda s: (-s.share if np.isfinite(s.share) else 0.0, s.key))
