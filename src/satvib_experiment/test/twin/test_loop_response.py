# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Loops of the rigs near z = 1, where products of polynomials lose their digits.

Truth: the matrices of the sampled rig and the law's coefficients, evaluated with 60 decimal digits.
"""

from decimal import Decimal, localcontext

import numpy as np
import pytest
from numpy.testing import assert_allclose
from satvib_common.signals.integrator import leaky_integrator
from satvib_control.model_analysis.margins import loop_response, margins
from satvib_ident.models.iir_model import IirModel
from satvib_plant_sim.responses.one_strut import discrete_strut_model
from satvib_plant_sim.rig.rig import load_rig

RIGS = {'paper_3dof': (100.0, 50.0), 'clean_3dof': (1000.0, 350.0), 'soft_3dof': (1000.0, 350.0)}
FREQUENCIES = np.array([9.0, 10.0, 20.0])


class Exact:
    """A complex number with as many digits as the context has."""

    def __init__(self, re, im=0.0):
        self.re, self.im = Decimal(re), Decimal(im)

    def __add__(self, other):
        return Exact(self.re + other.re, self.im + other.im)

    def __sub__(self, other):
        return Exact(self.re - other.re, self.im - other.im)

    def __mul__(self, other):
        a, b, c, d = self.re, self.im, other.re, other.im
        return Exact(a * c - b * d, a * d + b * c)

    def __truediv__(self, other):
        size = other.re * other.re + other.im * other.im
        turned = self * Exact(other.re, -other.im)
        return Exact(turned.re / size, turned.im / size)

    def __abs__(self):
        return (self.re * self.re + self.im * self.im).sqrt()


def polynomial(coefficients, zi):
    total = Exact(0)
    for c in reversed(list(coefficients)):
        total = total * zi + Exact(float(c))
    return total


def solved(matrix, right):
    """x of matrix x = right, by Gaussian elimination with pivots."""
    n = len(right)
    rows = [[*row, b] for row, b in zip(matrix, right, strict=True)]
    for k in range(n):
        best = max(range(k, n), key=lambda r: abs(rows[r][k]))
        rows[k], rows[best] = rows[best], rows[k]
        for r in range(k + 1, n):
            factor = rows[r][k] / rows[k][k]
            rows[r] = [a - factor * b for a, b in zip(rows[r], rows[k], strict=True)]
    x = [Exact(0)] * n
    for k in reversed(range(n)):
        rest = rows[k][n]
        for c in range(k + 1, n):
            rest = rest - rows[k][c] * x[c]
        x[k] = rest / rows[k][k]
    return x


def exact_loop(sampled, law, gain, omega):
    """L at the z = e^{j omega} of double precision."""
    z = Exact(float(np.cos(omega)), float(np.sin(omega)))
    zi, n = Exact(1) / z, len(sampled.A)
    matrix = [
        [Exact(-float(sampled.A[r, c])) + (z if r == c else Exact(0)) for c in range(n)]
        for r in range(n)
    ]
    late = [0.0] * sampled.late
    right = [polynomial([*late, *row], zi) for row in sampled.B]
    plant = Exact(0)
    for c, x in zip(sampled.c, solved(matrix, right), strict=True):
        plant = plant + Exact(float(c)) * x
    num, den = (polynomial(c, zi) for c in law)
    return Exact(gain) * (num / den) * plant


def sampled_rig(name):
    rate, corner = RIGS[name]
    changes = {'acquisition.sample_rate': rate, 'acquisition.filter_corner': corner}
    return discrete_strut_model(load_rig(name, changes))


@pytest.mark.parametrize('name', RIGS)
@pytest.mark.parametrize('gain', [56.1, 229.5, -200.0])
def test_the_loop_of_a_rig_has_all_its_digits(name, gain):
    """1e-9 of |1 + L|; at soft_3dof, 1 kHz, 9 Hz and this gain the products of polynomials are wrong by 1e-2."""
    sampled = sampled_rig(name)
    law = leaky_integrator(0.5, sampled.dt)
    omega = 2 * np.pi * FREQUENCIES * sampled.dt
    found = np.abs(1.0 + loop_response(sampled.response(FREQUENCIES), *law, gain, omega))
    with localcontext() as context:
        context.prec = 60
        truth = [abs(Exact(1) + exact_loop(sampled, law, gain, w)) for w in omega]
        assert_allclose(found, [float(t) for t in truth], rtol=1e-9)


@pytest.mark.parametrize('name', RIGS)
def test_the_margins_of_a_model_are_those_of_its_rig(name):
    """Truth: the least |1 + L| of the rig on a dense grid; 1e-4 for the coefficients of the model."""
    sampled = sampled_rig(name)
    law = leaky_integrator(0.5, sampled.dt)
    a, b, delay = sampled.coefficients()
    f = np.geomspace(1e-4, 0.5, 20000) / sampled.dt
    distance = np.abs(
        1.0 + loop_response(sampled.response(f), *law, 100.0, 2 * np.pi * f * sampled.dt)
    )
    modulus = margins(IirModel(a, b, delay, sampled.dt), *law, 100.0).modulus
    assert modulus == pytest.approx(distance.min(), rel=1e-4)
