# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Distributions of a campaign's parameters, each by its quantile function x = F^-1(u), u in (0, 1).

| kind | keys | F^-1(u) |
|---|---|---|
| uniform | low, high | low + (high - low) u |
| normal | mean, deviation | mean + deviation z(u) |
| lognormal | median, spread | median exp(spread z(u)) |
| choice | values, weights | the value whose share of the line from 0 to 1 holds u |

z is the standard normal quantile; `spread` is the deviation of the logarithm. A normal or lognormal distribution may be
cut off by low and high: u is then mapped to the part between, so what is cut off is spread over the rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.schema import LARGEST_INTEGER, Schema, param, shown

KINDS = ('uniform', 'normal', 'lognormal', 'choice')
_NEEDED = {
    'uniform': ('low', 'high'),
    'normal': ('mean', 'deviation'),
    'lognormal': ('median', 'spread'),
    'choice': ('values',),
}
_ALLOWED = {
    'uniform': ('low', 'high', 'whole'),
    'normal': ('mean', 'deviation', 'low', 'high', 'whole'),
    'lognormal': ('median', 'spread', 'low', 'high', 'whole'),
    'choice': ('values', 'weights'),
}
_STANDARD = NormalDist()
EDGE = 2.0**-40  # points are drawn between this and 1 less this


def _exponential(factor: float, exponent: float) -> float:
    try:
        return factor * math.exp(exponent)
    except OverflowError:
        return math.inf


@dataclass(frozen=True, kw_only=True)
class Distribution(Schema):
    """How one parameter varies from trial to trial."""

    kind: str = param(description='which distribution', choices=KINDS)
    low: float | None = param(None, 'least value')
    high: float | None = param(None, 'largest value')
    mean: float | None = param(None, 'mean of the normal distribution')
    deviation: float | None = param(None, 'standard deviation of it', above=0.0)
    median: float | None = param(None, 'median of the lognormal distribution', above=0.0)
    spread: float | None = param(None, 'standard deviation of the logarithm', above=0.0)
    values: tuple[Any, ...] = param((), 'what is chosen from')
    weights: tuple[float, ...] = param((), 'how often; equal without', above=0.0)
    whole: bool = param(False, 'rounded to whole numbers')

    def check(self) -> None:
        """Refuse keys of another kind, missing ones, and ranges with nothing in them."""
        for name in _NEEDED[self.kind]:
            if getattr(self, name) in (None, ()):
                raise SatvibError(f'{name}: missing, {self.kind} needs it')
        for name in ('low', 'high', 'mean', 'deviation', 'median', 'spread', 'values', 'weights'):
            if name not in _ALLOWED[self.kind] and getattr(self, name) not in (None, ()):
                raise SatvibError(f'{name}: does not belong to {self.kind}')
        if self.low is not None and self.high is not None and not self.low < self.high:
            raise SatvibError(f'low, high: nothing lies between {self.low} and {self.high}')
        if self.weights and len(self.weights) != len(self.values):
            raise SatvibError(f'weights: {len(self.weights)} for {len(self.values)} values')
        if self.kind in {'normal', 'lognormal'} and not self._share()[1] > self._share()[0]:
            raise SatvibError(f'low, high: the {self.kind} distribution has nothing between them')
        self._check_range()

    def _check_range(self) -> None:
        """Refuse a distribution that gives numbers which cannot be held, and values that are no JSON."""
        if self.kind == 'choice':
            for value in self.values:
                if isinstance(value, int) and abs(value) > LARGEST_INTEGER:
                    raise SatvibError(f'values: {shown(value)} is beyond 2^63 - 1')
            return
        if not math.isfinite((self.high or 0.0) - (self.low or 0.0)):
            raise SatvibError(f'low, high: from {self.low:g} to {self.high:g} reaches too far')
        for u in (EDGE, 1.0 - EDGE):
            x = self._number(u)
            if not math.isfinite(x) or (self.whole and abs(x) > LARGEST_INTEGER):
                names = ', '.join(_NEEDED[self.kind])
                raise SatvibError(f'{names}: the {self.kind} distribution reaches {x:g}')

    def _cumulative(self, x: float) -> float:
        """Probability below x, of the normal kinds."""
        if self.kind == 'normal':
            return _STANDARD.cdf((x - (self.mean or 0.0)) / (self.deviation or 1.0))
        if x <= 0.0:
            return 0.0
        return _STANDARD.cdf(math.log(x / (self.median or 1.0)) / (self.spread or 1.0))

    def _share(self) -> tuple[float, float]:
        below = 0.0 if self.low is None else self._cumulative(self.low)
        above = 1.0 if self.high is None else self._cumulative(self.high)
        return below, above

    def quantile(self, u: float) -> Any:
        """Give the value at probability u in (0, 1); a number, or one of the values of a choice."""
        if self.kind == 'choice':
            return self._chosen(u)
        x = self._number(u)
        return round(x) if self.whole else x

    def _number(self, u: float) -> float:
        """Value at probability u before it is rounded; infinite where it is beyond a float."""
        if self.kind == 'uniform':
            x = (self.low or 0.0) + ((self.high or 0.0) - (self.low or 0.0)) * u
        else:
            below, above = self._share()
            inside = below + (above - below) * u
            z = _STANDARD.inv_cdf(min(max(inside, 1e-300), 1.0 - 2.0**-53))
            if self.kind == 'normal':
                x = (self.mean or 0.0) + (self.deviation or 0.0) * z
            else:
                x = _exponential((self.median or 0.0), (self.spread or 0.0) * z)
        # rounding must not carry a value out of its range
        x = x if self.low is None else max(x, self.low)
        return x if self.high is None else min(x, self.high)

    def _chosen(self, u: float) -> Any:
        weights = self.weights or (1.0,) * len(self.values)
        rest = u * sum(weights)
        for value, weight in zip(self.values, weights, strict=True):
            rest -= weight
            if rest < 0.0:
                return value
        return self.values[-1]

    @property
    def ordered(self) -> bool:
        """Whether the values are numbers, so that more and less mean something."""
        return all(isinstance(v, int | float) and not isinstance(v, bool) for v in self.values)
