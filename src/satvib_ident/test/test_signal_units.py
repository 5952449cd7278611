# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A model does not depend on the units of its signals; signals of the usual size are not touched at all."""

import numpy as np
import pytest
from satvib_common.phases import Phase
from satvib_ident.excitation.factory import make_excitation
from satvib_ident.identifier import IdentifierCore
from satvib_ident.models.iir_model import IirModel
from satvib_ident.parameters import IdentifierParameters
from satvib_ident.signal_units import WATCHED, SignalUnits

PLANT = IirModel([-1.5, 0.7], [1.0, 0.5, 0.2], 1, 0.01)


def record(noise=0.0, samples=500):
    u = np.concatenate(
        [np.zeros(100), make_excitation('prbs', amplitude=5.0, dt=0.01).samples(samples)]
    )
    y = PLANT.simulate(u) + 0.3 + noise * np.random.default_rng(3).normal(size=len(u))
    return y, np.append(0.0, u)[:-1]


def identified(y, u, **options):
    core = IdentifierCore(IdentifierParameters(delay=1, **options), y.shape[:-1])
    found = None
    for k in range(y.shape[-1]):
        found = core.step(k, Phase.CALIBRATE if k < 100 else Phase.IDENTIFY, y[..., k], u[..., k])
    return found


UNITS = [(1e-12, 1e-12), (1e12, 1e12), (1e-12, 1.0), (1.0, 1e-12), (1e12, 1e-12), (1.0, 1.0)]


@pytest.mark.parametrize(
    ('estimator', 'tolerance'),
    [('least_squares', 1e-6), ('extended', 1e-6), ('instrumental', 3e-3)],
)
@pytest.mark.parametrize(('sy', 'su'), UNITS)
def test_the_same_model_in_every_unit(sy, su, estimator, tolerance):
    """Truth: the plant that made the record, without noise.

    Tolerance: of the prior; instruments come from a model that is still being learnt, which leaves 2e-3 in any unit.
    """
    y, u = record()
    found = identified(sy * y, su * u, estimator=estimator)
    np.testing.assert_allclose(found.a, PLANT.a, atol=tolerance)
    np.testing.assert_allclose(found.b * su / sy, PLANT.b, atol=tolerance)
    assert float(found.bias) == pytest.approx(0.3 * sy, rel=1e-9)
    assert bool(found.converged), found.reason


@pytest.mark.parametrize('size', [2.0**-40, 2.0**40])
def test_deviations_and_noise_are_in_the_units_of_the_signals(size):
    """Truth: the record in its own units, from the sample on from which both learn."""
    y, u = record(noise=0.05)
    found = identified(size * y, size * u)
    late = u.copy()
    late[: 101 + WATCHED] = np.nan  # what the first look costs
    plain = identified(y, late)
    np.testing.assert_allclose(found.a, plain.a, rtol=1e-3)
    np.testing.assert_allclose(found.b, plain.b, rtol=1e-3)
    np.testing.assert_allclose(found.standard_deviation, plain.standard_deviation, rtol=0.02)
    assert float(found.noise_variance) == pytest.approx(
        size**2 * float(plain.noise_variance), rel=0.02
    )


def test_signals_of_the_usual_size_are_counted_as_they_are():
    """Truth: by hand."""
    units = SignalUnits(())
    generator = np.random.default_rng(1)
    for _ in range(100):
        changed = units.watch(generator.normal(), generator.normal())
        assert not changed
    assert units.settled
    assert units.are_one
    assert (units.output, units.input) == (1.0, 1.0)


def test_an_item_of_a_batch_changes_alone():
    """Truth: the items run by themselves, to the last bit."""
    y, u = record(noise=0.01)
    sizes = np.array([1.0, 1e-12])
    both = identified(sizes[:, None] * y, sizes[:, None] * u)
    for i, size in enumerate(sizes):
        alone = identified(size * y, size * u)
        assert np.array_equal(both.a[i], alone.a)
        assert np.array_equal(both.b[i], alone.b)
        assert np.array_equal(both.standard_deviation[i], alone.standard_deviation)


def test_an_output_that_moves_late_is_waited_for():
    """Truth: by hand: dead time of 50 samples, then 1e-12; the next powers of two above 1e-12 and 1."""
    units = SignalUnits(())
    for _ in range(50):
        assert not units.watch(np.array(0.0), np.array(1.0))
    assert not units.settled
    assert units.watch(np.array(1e-12), np.array(1.0))
    assert units.output == 2.0**-39
    assert units.input == 2.0
