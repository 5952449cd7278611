# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Distributions, even sampling and the ranking of parameters against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_studies.campaign.drawing.distribution import Distribution
from satvib_studies.campaign.drawing.sampling import draw, unit_points
from satvib_studies.campaign.measures.sensitivity import (
    correlation_ratio,
    rank_correlation,
    ranking,
)
from satvib_studies.campaign.settings import Campaign
from scipy import stats

U = {'kind': 'uniform', 'low': 0.0, 'high': 1.0}


def campaign(**changes):
    told = {'name': 'c', 'scenario': 'quick_3dof', 'trials': 64, 'parameters': {'a': U, 'b': U}}
    return Campaign(**told | changes)


@given(st.floats(1e-6, 1.0 - 1e-6))
def test_quantiles_are_those_of_scipy(u):
    """Truth: scipy's independent quantile functions, 1e-9 relative; truncated ones by its truncnorm, 1e-6."""
    normal = Distribution(kind='normal', mean=3.0, deviation=0.5)
    assert normal.quantile(u) == pytest.approx(stats.norm(3.0, 0.5).ppf(u), rel=1e-9)
    log = Distribution(kind='lognormal', median=2.0, spread=0.3)
    assert log.quantile(u) == pytest.approx(stats.lognorm(0.3, scale=2.0).ppf(u), rel=1e-9)
    cut = Distribution(kind='normal', mean=0.0, deviation=1.0, low=-1.0, high=2.0)
    assert cut.quantile(u) == pytest.approx(stats.truncnorm(-1.0, 2.0).ppf(u), rel=1e-6, abs=1e-8)
    uniform = Distribution(kind='uniform', low=-2.0, high=5.0)
    assert uniform.quantile(u) == -2.0 + 7.0 * u


def test_a_choice_follows_its_weights():
    """Truth: shares of the line; exact."""
    d = Distribution(kind='choice', values=('x', 'y', 'z'), weights=(1.0, 2.0, 1.0))
    assert [d.quantile(u) for u in (0.1, 0.24, 0.26, 0.74, 0.76)] == ['x', 'x', 'y', 'y', 'z']


@pytest.mark.parametrize(
    ('keys', 'told'),
    [
        ({'kind': 'uniform', 'low': 2.0, 'high': 1.0}, 'nothing lies between 2.0 and 1.0'),
        ({'kind': 'uniform', 'low': 2.0}, 'high: missing'),
        ({'kind': 'normal', 'mean': 1.0, 'deviation': -1.0}, 'not above 0'),
        ({'kind': 'normal', 'mean': 0.0, 'deviation': 1.0, 'low': 50.0}, 'has nothing between'),
        ({'kind': 'uniform', 'low': 0.0, 'high': 1.0, 'mean': 3.0}, 'does not belong to uniform'),
        ({'kind': 'choice'}, 'values: missing'),
        ({'kind': 'choice', 'values': [1, 2], 'weights': [1.0]}, '1 for 2 values'),
        ({'kind': 'gauss'}, 'not one of uniform'),
    ],
)
def test_distributions_that_make_no_sense_are_refused(keys, told):
    """Truth: what the page on campaigns says; the message names the key."""
    with pytest.raises(SatvibError, match=told):
        Distribution.from_mapping(keys, 'x')


@pytest.mark.parametrize('trials', [16, 37, 64])
def test_a_latin_hypercube_has_one_point_in_every_slice(trials):
    """Truth: the definition of McKay et al.; exact."""
    points = unit_points(campaign(trials=trials))
    for column in points.T:
        assert sorted(np.floor(column * trials).astype(int)) == list(range(trials))


def test_sobol_points_fill_every_box():
    """Truth: 64 = 8 x 8 scrambled points of a (0, m, 2) net lie one in each of 8 x 8 boxes; exact."""
    points = unit_points(campaign(sampling='sobol'))
    boxes = {tuple(box) for box in np.floor(points * 8.0).astype(int)}
    assert len(boxes) == 64


def test_a_seed_decides_everything():
    """Truth: the definition; equal in every bit, and another seed is another draw."""
    assert draw(campaign(seed=5)) == draw(campaign(seed=5))
    assert draw(campaign(seed=5)) != draw(campaign(seed=6))


def test_ranking_finds_the_shares_of_a_known_sum():
    """Truth: y = 3 a + (2 b - 1)^2 sqrt(45/4) has Var = 9/12 + 1 of which 3/7 is a's and 4/7 b's; 0.03 at 8192 points.

    Spearman of the even dependence on b is 0 within 0.03; an idle parameter has a share below 0.01.
    """
    c = campaign(trials=8192, sampling='sobol', parameters={'a': U, 'b': U, 'idle': U})
    values = {k: np.array(v) for k, v in draw(c).items()}
    y = 3.0 * values['a'] + (2.0 * values['b'] - 1.0) ** 2 * math.sqrt(45.0 / 4.0)
    found = {s.key: s for s in ranking(values, y)}
    assert found['a'].share == pytest.approx(3.0 / 7.0, abs=0.03)
    assert found['b'].share == pytest.approx(4.0 / 7.0, abs=0.03)
    assert found['idle'].share < 0.01
    assert abs(found['b'].rank) < 0.03 < 0.5 < found['a'].rank
    assert [s.key for s in ranking(values, y)] == ['b', 'a', 'idle']


def test_texts_have_a_share_and_no_direction():
    """Truth: two groups with means -1 and 1 and no scatter: all of the variance; exact."""
    names = ['off', 'on'] * 20
    y = np.array([-1.0, 1.0] * 20)
    assert correlation_ratio(names, y) == pytest.approx(1.0)
    assert math.isnan(rank_correlation(names, y))
