# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's Eqs. (40) and (41): what is printed, and what the derivative is.

Truth: the derivative of Eq. (40) itself with dual numbers, and its complex step where everything is real; 1e-12.
"""

import numpy as np
import pytest

T = 0.01
A1, A2, B1, B2, B3 = -0.460, 0.158, 0.061, -0.103, 0.033  # the paper's G(z)
STEP = 1e-30


def polynomials(zi):
    """P and Q of H = -K_i P / (Q - K_i P): the terms of Eq. (40) with and without K_i."""
    p = T * (B1 + (B1 + B2) * zi + (B2 + B3) * zi**2 + B3 * zi**3)
    q = 2 + (2 * A1 - 2) * zi + (2 * A2 - 2 * A1) * zi**2 - 2 * A2 * zi**3
    return p, q


def closed_loop(k, zi):
    p, q = polynomials(zi)
    return -k * p / (q - k * p)


def derivative(k, zi):
    """dH/dK_i with dual numbers: values and slopes of numerator and denominator."""
    p, q = polynomials(zi)
    value, slope = -k * p, -p
    below, below_slope = q - k * p, -p
    return slope / below - value * below_slope / below**2


def mended(k, zi):
    p, q = polynomials(zi)
    below = q - k * p
    return -p / below - k * p * p / below**2


def printed(k, zi):
    p, q = polynomials(zi)
    below = q - k * p
    return -p / below - (k * p / below) * (-p)


@pytest.mark.parametrize('frequency', [1.0, 10.0, 37.0])
@pytest.mark.parametrize('gain', [-200.0, -50.0, 20.0])
def test_the_second_term_needs_a_square_and_the_other_sign(gain, frequency):
    zi = np.exp(-2j * np.pi * frequency * T)
    exact = derivative(gain, zi)
    assert mended(gain, zi) == pytest.approx(exact, rel=1e-12)
    assert abs(printed(gain, zi) - exact) > 1e-3 * abs(exact)
    p, q = polynomials(zi)
    only_squared = -p / (q - gain * p) + gain * p * p / (q - gain * p) ** 2
    assert abs(only_squared - exact) > 1e-3 * abs(exact)


def test_with_real_numbers_the_complex_step_says_the_same():
    """Truth: Im H(K + j h) / h at z = 2, where everything is real."""
    zi = 0.5
    step = closed_loop(-50.0 + 1j * STEP, zi).imag / STEP
    assert mended(-50.0, zi) == pytest.approx(step, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize('frequency', [1.0, 10.0, 37.0])
def test_equation_40_has_the_gain_of_36_and_38_with_the_other_sign(frequency):
    """Truth: D G / (1 + D G) of Eqs. (36), (38), (39) with -K_i in the place of K_i."""
    zi = np.exp(-2j * np.pi * frequency * T)
    k = -50.0
    g = (B1 + B2 * zi + B3 * zi**2) / (1 + A1 * zi + A2 * zi**2)
    d = -k * T / 2 * (1 + zi) / (1 - zi)
    assert closed_loop(k, zi) == pytest.approx(d * g / (1 + d * g), rel=1e-12)
