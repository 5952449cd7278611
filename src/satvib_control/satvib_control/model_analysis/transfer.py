# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Polynomials in z^-1, lowest power first, for the design of laws from the identified model.

The model y(k) + a1 y(k-1) + ... = b1 u(k-delay) + ... is B(z)/A(z) with A = 1 + a1 z^-1 + ... and the delay as
leading zeros of B. u(k) is computed from y(k), so the delay must be at least 1 for the loop to be causal.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.horner_rule import horner, polynomial
from satvib_common.kernels.schur_cohn import inside_unit_circle
from satvib_ident.models.iir_model import IirModel


def model_polynomials(model: IirModel) -> tuple[Array, Array]:
    """Give (B, A) of a model, (..., p) each, of equal length, the delay included in B."""
    a, b = np.asarray(model.a, dtype=float), np.asarray(model.b, dtype=float)
    length = max(1 + a.shape[-1], model.delay + b.shape[-1])
    den = np.zeros((*a.shape[:-1], length))
    num = np.zeros((*b.shape[:-1], length))
    den[..., 0] = 1.0
    den[..., 1 : 1 + a.shape[-1]] = a
    num[..., model.delay : model.delay + b.shape[-1]] = b
    return num, den


def broadcast_model(model: IirModel, shape: tuple[int, ...]) -> IirModel:
    """Give a model with the leading axes `shape`, so that every item has its own."""
    a, b = model.a, model.b
    return IirModel(
        np.broadcast_to(a, (*shape, a.shape[-1])),
        np.broadcast_to(b, (*shape, b.shape[-1])),
        model.delay,
        model.dt,
    )


def multiply(p: ArrayLike, q: ArrayLike) -> Array:
    """Product of polynomials (..., m) and (..., n), in a fixed order of additions: (..., m + n - 1)."""
    p, q = np.asarray(p, dtype=float), np.asarray(q, dtype=float)
    shape = np.broadcast_shapes(p.shape[:-1], q.shape[:-1])
    result = np.zeros((*shape, p.shape[-1] + q.shape[-1] - 1))
    for i in range(p.shape[-1]):
        result[..., i : i + q.shape[-1]] += p[..., i : i + 1] * q
    return result


def value(c: ArrayLike, zi: complex) -> complex:
    """One polynomial (p,) at one z^-1, by Horner's rule."""
    result: complex = polynomial(np.asarray(c, dtype=float).tolist(), zi)
    return result


@njit
def ratio(b: Any, a: Any, zi: complex) -> complex:
    """B/A at one z^-1, by Horner's rule, for kernels."""
    return horner(b, zi) / horner(a, zi)


@njit
def respond(b: Any, a: Any, omega: float) -> complex:
    """B/A at e^{j omega}, for kernels."""
    return ratio(b, a, complex(math.cos(omega), -math.sin(omega)))


@kernel('void(f8[:], f8[:])', '(n)->()')
def stable(a: Any, out: Any) -> None:
    """1 where all roots in z of a polynomial in z^-1 lie inside the unit circle, else 0; a[0] may be any but 0."""
    out[0] = 0.0
    for i in range(a.shape[0]):
        if not np.isfinite(a[i]):
            return
    if a[0] != 0.0 and inside_unit_circle(a[1:] / a[0]):
        out[0] = 1.0
