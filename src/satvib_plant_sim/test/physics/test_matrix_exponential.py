# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The matrix exponential kernel."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose, assert_array_equal
from satvib_plant_sim.physics.matrix_exponential import exponential
from satvib_plant_sim.rig.rig import load_rig
from satvib_plant_sim.stepping.discretize import full_system
from scipy.linalg import expm


def extended(matrix):
    """exp by scaling and squaring in long double, no balancing, more terms: 64 bits of mantissa."""
    x = matrix.astype(np.longdouble) / np.longdouble(2) ** 14
    term = total = np.eye(len(matrix), dtype=np.longdouble)
    for k in range(1, 22):
        term = term @ x / k
        total = total + term
    for _ in range(14):
        total = total @ total
    return total.astype(float)


@pytest.mark.parametrize('name', ['paper_3dof', 'clean_3dof', 'soft_3dof'])
@pytest.mark.parametrize('time', [1e-5, 0.25e-3, 5e-3])
def test_every_entry_of_a_rigs_transition_is_right(name, time):
    """Truth: extended precision; 1e-11 relative, entry by entry, over a step; 1e-10 over a sample, after squarings."""
    A = full_system(load_rig(name)).A * time
    truth, found = extended(A), exponential(A)
    there = np.abs(truth) > 1e-25 * np.abs(truth).max()
    assert_allclose(found[there], truth[there], rtol=1e-11 if time < 1e-3 else 1e-10)


@settings(max_examples=40, deadline=None)
@given(arrays(float, (5, 5), elements=st.floats(-3.0, 3.0)))
def test_any_matrix(matrix):
    """Truth: scipy's expm; 1e-11 of the largest entry."""
    truth = expm(matrix)
    assert_allclose(exponential(matrix), truth, atol=1e-11 * np.abs(truth).max())


def test_closed_forms():
    """Truth: exp(0) = 1, a nilpotent matrix (a polynomial), a rotation; 1e-15."""
    assert_array_equal(exponential(np.zeros((3, 3))), np.eye(3))
    N = np.array([[0.0, 2.0, 0.0], [0.0, 0.0, 3.0], [0.0, 0.0, 0.0]])
    assert_allclose(exponential(N), np.eye(3) + N + N @ N / 2, atol=1e-15)
    R = exponential(np.array([[0.0, 1.0], [-1.0, 0.0]]))
    assert_allclose(R, [[np.cos(1), np.sin(1)], [-np.sin(1), np.cos(1)]], atol=1e-15)


def test_bits_do_not_depend_on_the_batch():
    """Truth: one matrix at a time; exact."""
    many = np.random.default_rng(0).normal(size=(4, 3, 6, 6))
    together = exponential(many)
    for i in np.ndindex(4, 3):
        assert_array_equal(together[i], exponential(many[i]))
