# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Directional forgetting: forget only where new data come in (subspace of information forgetting).

The recent regressors span a subspace: the eigenvectors V of their mean square

    S(k) = mu S(k-1) + (1 - mu) w w^T

with eigenvalues above epsilon^2 (the information filter: what is shorter is noise; a sample with |w| < epsilon is
left out altogether, or noise alone would gnaw at what is known). Before each measurement, with R
= P^-1,

    R <- R - (1 - lambda) R V (V^T R V)^-1 V^T R     that is     P <- P + (1/lambda - 1) V (V^T R V)^-1 V^T

What the data do not reach is kept for ever, so P stays bounded without any excitation; where they reach everything,
it is exponential forgetting. lambda is the smaller of a constant and of what the F test of `variable_rate` says.
(With the last regressor alone for V, as for a single measurement in the papers, a weakly excited direction is hardly
ever forgotten: after a change of the paper's plant a1 is still off by 40 % after two seconds.)

L. Cao and H. Schwartz, A directional forgetting algorithm based on the decomposition of the information matrix,
Automatica 36, 2000; B. Lai and D. S. Bernstein, SIFt-RLS, arXiv:2404.10844, 2024 (bounds on P without excitation).
"""

import numpy as np
from numpy.typing import NDArray
from satvib_common.errors import SatvibError
from satvib_common.kernel import kernel

from satvib_ident import ud
from satvib_ident.eigenvalues import strong_directions
from satvib_ident.forgetting.exponential import checked_factor
from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Factors
from satvib_ident.forgetting.variable_rate import VariableRateForgetting

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@kernel('void(f8[:], f8, b1, f8[:,:], b1[:])', '(p),(),(),(p,p)->()', writable=('S',))
def _remember(w, fade, active, S, taken):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """S <- fade S + (1 - fade) w w^T where active; what `measure` would refuse must not get into S either."""
    p = w.shape[0]
    taken[0] = active
    for i in range(p):
        if not abs(w[i]) < 1e60:
            taken[0] = False
    if taken[0]:
        for i in range(p):
            for j in range(p):
                S[i, j] = fade * S[i, j] + (1.0 - fade) * (w[i] * w[j])


class DirectionalForgetting(NoForgetting):
    """Forget in the subspace of the recent regressors.

    Args:
        factor: lambda in (0, 1] while nothing changes.
        floor: epsilon, RMS of the regressor along a direction, in its mixed units (m/s^2, V).
        window: samples after which a regressor has mostly left S, 1 / (1 - mu).
        test: says lambda after a change; None for a constant lambda.
    """

    def __init__(
        self,
        factor: float,
        floor: float = 0.0,
        window: float = 20.0,
        test: VariableRateForgetting | None = None,
    ) -> None:
        self.factor = checked_factor(factor)
        if not floor >= 0.0:
            raise SatvibError(f'regressor_floor: {floor} is negative')
        if not window >= 1.0:
            raise SatvibError(f'directional forgetting: a window of {window} samples')
        self._floor, self._fade = floor * floor, 1.0 - 1.0 / window
        self._test = test

    def bind(self, estimator: Factors) -> None:
        """Make room for S and for the windows of the test."""
        self._S = np.zeros((*estimator.shape, estimator.count, estimator.count))
        if self._test is not None:
            self._test.bind(estimator)

    def apply(
        self, estimator: Factors, w: Array, error: Array, active: Mask
    ) -> tuple[Array | float, Array, Mask]:
        """Leave out what is shorter than the floor; forget where the recent regressors reach."""
        if self._floor > 0.0:
            active = active & (ud.dot(w, w) >= self._floor)
        factor: Array | float = self.factor
        if self._test is not None:
            tested, _, _ = self._test.apply(estimator, w, error, active)
            factor = np.minimum(self.factor, tested)
        good = np.asarray(_remember(w, self._fade, active, self._S))
        V, everything = strong_directions(self._S, self._floor, good)
        part = good & ~everything
        if part.any():
            ud.forget_within(V, factor, estimator.limit, part, estimator.U, estimator.d)
        return np.where(everything, factor, 1.0), error, active

    def reset(self, mask: Mask) -> None:
        """Empty S and the windows of the test."""
        self._S[...] = np.where(mask[..., None, None], 0.0, self._S)
        if self._test is not None:
            self._test.reset(mask)
