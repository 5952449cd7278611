# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Records with offsets, gaps, delays and in any unit: the model is that of the same record without them.

Truth: numpy.linalg.lstsq over the rows that are complete, or the parameters with which a record was made.
"""

import numpy as np
import pytest
from satvib_ident.estimators.extended import ExtendedLeastSquares
from satvib_ident.estimators.instrumental import InstrumentalVariable
from satvib_ident.models.iir_model import IirModel
from satvib_ident.offline.compressed import known_rows, matrix, regress, triangle
from satvib_ident.offline.delay import find_delay
from satvib_ident.offline.order_search import identify
from satvib_ident.offline.recursion import RecordEstimator
from satvib_ident.offline.result import Offset

PLANT = IirModel([-1.5, 0.7], [0.0, 1.0, 0.5], 0, 0.01)
N = 600
ORDER = [(2, 3, 0)]


def make(noise=0.002, samples=N, seed=1, plant=PLANT):
    """Output and input of the plant under PRBS of 1 V with output noise."""
    generator = np.random.default_rng([seed])
    u = generator.choice([-1.0, 1.0], samples)
    return plant.simulate(u) + noise * generator.normal(size=samples), u


def rows_of(y, u, n, m, delay=0, ones=False):
    """Regressors and targets of all complete rows, by hand."""
    W, target = [], []
    for k in range(max(n, delay + m - 1), len(y)):
        row = np.concatenate(
            [-y[k - n : k][::-1], u[k - delay - m + 1 : k - delay + 1][::-1], [1.0] if ones else []]
        )
        if np.isfinite(row).all() and np.isfinite(y[k]):
            W.append(row)
            target.append(y[k])
    return np.linalg.lstsq(np.array(W), np.array(target), rcond=None)[0]


@pytest.mark.parametrize('y_unit', [1e-12, 1e-10, 1.0, 1e6, 1e12, 1e100, 1e-100])
@pytest.mark.parametrize('u_unit', [1e-12, 1.0, 1e9])
def test_a_model_does_not_depend_on_units(y_unit, u_unit):
    """A is the same to 1e-11, B and its deviation scale with the units, AIC shifts by 2 N ln of the unit."""
    y, u = make()
    plain, other = (
        identify(y, u, 0.01, ORDER).chosen,
        identify(y_unit * y, u_unit * u, 0.01, ORDER).chosen,
    )
    np.testing.assert_allclose(other.model.a, plain.model.a, rtol=1e-11)
    np.testing.assert_allclose(
        other.model.b * u_unit / y_unit, plain.model.b, rtol=1e-9, atol=1e-13
    )
    np.testing.assert_allclose(
        other.standard_deviation[:2], plain.standard_deviation[:2], rtol=1e-9
    )
    assert other.aic == pytest.approx(plain.aic + (N - 2) * 2.0 * np.log(y_unit), rel=1e-9)


@pytest.mark.parametrize('method', ['extended', 'instrumental'])
@pytest.mark.parametrize('unit', [1e-12, 1e12])
def test_recursions_do_not_depend_on_units(method, unit):
    """Their prior is the same share of the record's own unit; 1e-6 of the parameters."""
    y, u = make(0.05)
    plain, other = identify(y, u, 0.01, ORDER, method), identify(unit * y, u, 0.01, ORDER, method)
    np.testing.assert_allclose(other.model.a, plain.model.a, rtol=1e-6)


@pytest.mark.parametrize(
    ('y_offset', 'u_offset'), [(981.0, 0.0), (-3e4, 0.0), (0.0, 24.0), (13.0, 2.4)]
)
def test_an_offset_is_found_and_taken_off(y_offset, u_offset):
    """numpy with a column of ones (1e-7: 3e4 leaves 12 digits of the signal); the free run is as good as without."""
    y, u = make()
    result = identify(y + y_offset, u + u_offset, 0.01, ORDER)
    truth = rows_of(y + y_offset, u + u_offset, 2, 3, ones=True)
    assert result.offset is Offset.CONSTANT
    np.testing.assert_allclose(result.model.theta, truth[:5], atol=1e-7)
    assert result.chosen.constant == pytest.approx(truth[5], abs=1e-3)
    assert result.chosen.validation_free_run > 0.999
    assert result.notes[-1].startswith('offset: constant term')


def test_without_an_offset_the_signals_stay_as_they_are():
    y, u = make()
    result = identify(y, u, 0.01, ORDER)
    assert result.offset is Offset.NONE
    assert result.chosen.constant == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(result.model.theta, rows_of(y, u, 2, 3), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    'lost', [lambda k: k % 10 == 7, lambda k: (k > 200) & (k < 230), lambda k: k % 41 == 0]
)
@pytest.mark.parametrize(('n', 'm', 'delay'), [(2, 3, 0), (1, 2, 1), (3, 1, 1), (4, 5, 0)])
def test_nothing_is_taken_across_a_gap(lost, n, m, delay):
    """numpy over the complete rows; the fits are those of the samples that are there."""
    y, u = make()
    y[lost(np.arange(N))] = np.nan
    u[lost(np.arange(N) + 3)] = np.nan
    result = identify(y, u, 0.01, [(n, m, delay)])
    np.testing.assert_allclose(
        result.model.theta, rows_of(y, u, n, m, delay), rtol=1e-8, atol=1e-10
    )
    if n == 2:
        assert result.chosen.one_step > 0.998
        assert result.chosen.free_run > 0.998


@pytest.mark.parametrize(
    'orders', [[(1, 2, 0), (2, 3, 0), (5, 6, 0), (8, 9, 0)], [(2, 1, 3), (3, 4, 0), (1, 5, 7)]]
)
def test_all_orders_come_from_one_triangle(orders):
    """Each is numpy's own solution over its own rows."""
    y, u = make(0.05)
    y[100], u[300:305] = np.nan, np.nan
    for candidate, order in zip(identify(y, u, 0.01, orders).candidates, orders, strict=True):
        np.testing.assert_allclose(
            candidate.model.theta, rows_of(y, u, *order), rtol=1e-8, atol=1e-9
        )


def test_the_triangle_keeps_all_inner_products():
    """R^T R = W^T W (1e-12), zeros below the diagonal, and regressions of any column are numpy's."""
    y, u = make(0.1, 3000)
    y[[5, 500]], u[100] = np.nan, np.nan
    columns = [('1', 0), ('y', 1), ('y', 2), ('u', 3), ('u', 5), ('y', 0)]
    known = known_rows(y, u, columns)
    by_hand = [
        all(
            k >= lag and np.isfinite((y if name == 'y' else u)[k - lag])
            for name, lag in columns[1:]
        )
        and np.isfinite(u[k - 4])  # lags 3 to 5 are taken as one window
        for k in range(3000)
    ]
    assert known.tolist() == by_hand
    rows = np.flatnonzero(known)
    R, W = triangle(y, u, columns, rows), matrix(y, u, columns, rows).T
    np.testing.assert_allclose(R.T @ R, W.T @ W, rtol=1e-12, atol=1e-9)
    assert not np.tril(R, -1).any()
    found = regress(R, 3, [0, 5, 2], len(rows))
    truth = np.linalg.lstsq(W[:, [0, 5, 2]], W[:, 3], rcond=None)
    np.testing.assert_allclose(found.theta, truth[0], rtol=1e-9, atol=1e-12)
    assert found.squares == pytest.approx(truth[1][0], rel=1e-9)


def test_dependent_columns_leave_their_coefficients_open():
    """A column twice: rank 2 of 3, an infinite deviation for both, the shortest solution."""
    y, u = make(0.1)
    columns = [('y', 1), ('u', 1), ('y', 0)]
    rows = np.arange(5, N)
    R = triangle(y, u, columns, rows)
    found = regress(R, 2, [0, 1, 1], len(rows))
    assert found.rank == 2
    assert np.isfinite(found.deviation).tolist() == [True, False, False]
    assert found.theta[1] == pytest.approx(found.theta[2])


@pytest.mark.parametrize('method', ['extended', 'instrumental'])
def test_the_compiled_loop_is_the_estimator_bit_for_bit(feed, method):
    """The classes of the node, sample by sample, on a record with gaps, in two parts."""
    y, u = make(0.05, 1500)
    y[300], u[700:710] = np.nan, np.nan
    make_one = {
        'extended': lambda: ExtendedLeastSquares(7, 3),
        'instrumental': lambda: InstrumentalVariable(3, 4),
    }
    truth = feed(make_one[method](), y, u, 3, 4, 2)
    run = RecordEstimator(method, 3, 4, 2)
    run.run(y, u, 600)
    run.run(y, u, len(y))
    assert np.array_equal(run.estimator.theta, truth.theta)
    assert np.array_equal(run.estimator.d, truth.d)
    assert np.array_equal(run.estimator.tally, truth.tally)


@pytest.mark.parametrize('dead', [5, 23, 40, 77])
@pytest.mark.parametrize('offset', [0.0, 500.0])
def test_a_delay_is_found(dead, offset):
    """The plant behind `dead` samples: the first input that counts is dead + 1 samples old."""
    y, u = make(0.05, 1000)
    late = np.concatenate([np.zeros(dead), y])[:1000] + offset
    found = find_delay(late, u)
    assert found.delay == dead + 1
    assert f'delay {dead + 1}, searched from 0 to 100: the error is smallest at {dead + 1}' in str(
        found
    )
    result = identify(late, u, 0.01, [(2, 3, found.delay)])
    assert result.chosen.validation_free_run > 0.98
    np.testing.assert_allclose(result.model.a, [-1.5, 0.7], atol=0.02)


@pytest.mark.parametrize('seed', range(5))
def test_no_delay_is_found_where_there_is_none(seed):
    y, u = make(0.05, 1000, seed)
    assert find_delay(y, u).delay == 0
    noise = np.random.default_rng([seed]).normal(size=1000)
    assert find_delay(noise, u).delay == 0
    assert find_delay(y[:8], u[:8]) is None
