# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Projection of several gains on what the identified model proves stable with a modulus margin.

With u = -(K_1 C_1 + K_2 C_2 + ...) y the loop is L = sum_j K_j L_j. Along the ray t K the condition |1 + t L(w)| >= mu
is a quadratic in t for each frequency, as in `gain_bounds`. t* is the smallest positive root over the grid. Where
t* < 1 the gains are multiplied by t*. Between 0 and the result all gains keep the margin, so the loop is stable.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

from satvib_control.model_analysis.transfer import ratio

POINTS = 384


@njit
def ray_limit(gains: Any, grid: Any, margin: Any) -> float:
    """Largest t for which t * gains (j) keep the margin; `grid` (2 j, points) has Re and Im of each L_j."""
    best = np.inf
    free = 1.0 - margin * margin
    for i in range(grid.shape[1]):
        re = 0.0
        im = 0.0
        for j in range(gains.shape[0]):
            re += gains[j] * grid[2 * j, i]
            im += gains[j] * grid[2 * j + 1, i]
        if re >= 0.0:
            continue
        square = re * re + im * im
        root = re * re - square * free
        if root >= 0.0:
            best = min(best, free / (-re + math.sqrt(root)))
    return best


@kernel('void(f8[:], f8[:], f8[:], f8[:], f8[:], f8[:])', '(p),(r),(n),(n)->(n),(n)')
def _response(num: Any, den: Any, cos: Any, sin: Any, real: Any, imag: Any) -> None:
    """num/den at the points of the unit circle."""
    for i in range(cos.shape[0]):
        here = ratio(num, den, complex(cos[i], -sin[i]))
        real[i] = here.real
        imag[i] = here.imag


def loop_grid(numerators: list[ArrayLike], denominator: ArrayLike) -> Array:
    """Re and Im of each L_j on the grid, (..., 2 j, POINTS).

    Args:
        numerators: (..., p) each, in z^-1.
        denominator: (..., r), common to all.
    """
    w = [math.pi * math.exp(math.log(2e-4) * (1.0 - i / (POINTS - 1))) for i in range(POINTS)]
    cos, sin = np.array([math.cos(x) for x in w]), np.array([math.sin(x) for x in w])
    rows = []
    for numerator in numerators:
        rows.extend(_response(numerator, denominator, cos, sin))
    return np.stack(rows, axis=-2)


@kernel('void(f8[:], f8[:], f8[:,:], f8, f8[:])', '(j),(j),(g,n),()->(j)')
def ray(gains: Any, scale: Any, grid: Any, margin: Any, out: Any) -> None:
    """Gains (..., j) that keep the margin, near those asked for.

    First, a few times, a Newton step along the gradient of |1 + L|^2 at the worst frequency, in the metric of `scale`
    (..., j; a gain of scale 0 stays). So gains move along the bound instead of shrinking together. The result is then
    scaled down along the ray, which proves the margin.
    """
    count = gains.shape[0]
    slope = np.empty(count)
    wanted = margin * margin
    for i in range(count):
        out[i] = gains[i]
    for _ in range(6):
        worst = wanted
        where = -1
        for i in range(grid.shape[1]):
            re, im = 1.0, 0.0
            for j in range(count):
                re += out[j] * grid[2 * j, i]
                im += out[j] * grid[2 * j + 1, i]
            if re * re + im * im < worst:
                worst = re * re + im * im
                where = i
        if where < 0:
            break
        re, im = 1.0, 0.0
        for j in range(count):
            re += out[j] * grid[2 * j, where]
            im += out[j] * grid[2 * j + 1, where]
        total = 0.0
        for j in range(count):
            slope[j] = 2.0 * (re * grid[2 * j, where] + im * grid[2 * j + 1, where])
            total += slope[j] * slope[j] * scale[j] * scale[j]
        if total == 0.0:
            break
        for j in range(count):
            out[j] += 1.0001 * (wanted - worst) * slope[j] * scale[j] * scale[j] / total
    t = min(ray_limit(out, grid, margin), 1.0)
    for i in range(count):
        out[i] = t * out[i]
