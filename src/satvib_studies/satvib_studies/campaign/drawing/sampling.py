# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Points that fill the unit cube more evenly than chance, and the parameters that they stand for.

Latin hypercube (McKay, Beckman, Conover 1979, Technometrics 21, 239): every parameter has exactly one point in each of
`trials` equal slices. Sobol (1967), scrambled (Owen 1998): evenly in every combination of few parameters; best at
powers of two. Both come from scipy.stats.qmc with `default_rng([seed, 3])`; a trial is a row, whatever runs it.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
from satvib_common.arrays import Array

from satvib_studies.campaign.drawing.distribution import EDGE
from satvib_studies.campaign.settings import Campaign

STREAM = 3  # of a campaign's seed


def unit_points(campaign: Campaign) -> Array:
    """Give the points (trials, parameters), inside (0, 1)."""
    from scipy.stats import qmc  # slow to import, and what is wrong with a file should show at once

    rng = np.random.default_rng([campaign.seed, STREAM])
    dimensions = len(campaign.parameters)
    if campaign.sampling == 'sobol':
        source = qmc.Sobol(dimensions, scramble=True, rng=rng)
        # drawn to the next power of two and cut: balanced as far as it goes
        points = source.random_base2(max(math.ceil(math.log2(campaign.trials)), 0))
        points = points[: campaign.trials]
    else:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore', UserWarning)
            points = qmc.LatinHypercube(dimensions, rng=rng).random(campaign.trials)
    # a Sobol point may lie on the edge, where a normal distribution has no value
    inside: Array = np.clip(points, EDGE, 1.0 - EDGE)
    return inside


def draw(campaign: Campaign) -> dict[str, list[Any]]:
    """Give the values of every trial by key."""
    points = unit_points(campaign)
    return {
        key: [distribution.quantile(float(u)) for u in points[:, i]]
        for i, (key, distribution) in enumerate(campaign.distributions().items())
    }
