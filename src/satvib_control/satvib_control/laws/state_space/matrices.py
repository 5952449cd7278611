# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The matrices of a fixed linear controller: as parameters hold them, and what they do by frequency.

    u(k) = C x(k) + D y(k),    x(k+1) = A x(k) + B y(k) + E v(k)

y are m readings, u the m voltages that the controller asks for, v those that were applied. Where nothing limits the
voltage v = u, and the controller is the linear one of A + E C and B + E D.
"""

from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError

_PREFIX = 'state_space_'


class Matrices(NamedTuple):
    """A controller of p states with m readings and m voltages; see the module.

    Attributes:
        A: (p, p).
        B: (p, m).
        C: (m, p).
        D: (m, m).
        E: (p, m).
    """

    A: Array
    B: Array
    C: Array
    D: Array
    E: Array

    def parameters(self) -> dict[str, list[float]]:
        """Give the parameters of the law, row by row, with ten digits."""
        return {
            f'{_PREFIX}{name.lower()}': [float(f'{v:.10g}') for v in matrix.ravel()]
            for name, matrix in zip(self._fields, self, strict=True)
        }

    def linear(self) -> tuple[Array, Array]:
        """Give A + E C (p, p) and B + E D (p, m): the controller whose voltage is applied as it asks for it."""
        return self.A + self.E @ self.C, self.B + self.E @ self.D


def matrices_of(
    a: tuple[float, ...],
    b: tuple[float, ...],
    c: tuple[float, ...],
    d: tuple[float, ...],
    e: tuple[float, ...],
    channels: int,
) -> Matrices:
    """Give the matrices of parameters; an empty D or E is zero.

    Args:
        a, b, c, d, e: row by row.
        channels: m.

    Raises:
        SatvibError: numbers that do not fill the matrices; the first parameter that is wrong is named.
    """
    m = channels
    if not b or len(b) % m:
        raise SatvibError(
            f'{_PREFIX}b: {len(b)} numbers; a row of {m} for each state is expected, for one state at least'
        )
    p = len(b) // m
    found = {}
    for name, values, rows, columns in (
        ('a', a, p, p), ('b', b, p, m), ('c', c, m, p), ('d', d, m, m), ('e', e, p, m),
    ):  # fmt: skip
        if not values and name in 'de':
            values = (0.0,) * (rows * columns)
        if len(values) != rows * columns:
            raise SatvibError(
                f'{_PREFIX}{name}: {len(values)} numbers; {rows} rows of {columns} are expected for {p} states'
            )
        found[name.upper()] = np.array(values, dtype=float).reshape(rows, columns)
    return Matrices(**found)


def response(matrices: Matrices, omega: Array) -> Complex:
    """Give u/y (..., m, m) at frequencies (...) in rad/sample, where the voltage is applied as it is asked for."""
    A, B = matrices.linear()
    z = np.exp(1j * np.asarray(omega, dtype=float))[..., None, None]
    inside = np.linalg.solve(z * np.eye(len(A)) - A, np.broadcast_to(B, (*z.shape[:-2], *B.shape)))
    return np.asarray(matrices.C @ inside + matrices.D, dtype=complex)
