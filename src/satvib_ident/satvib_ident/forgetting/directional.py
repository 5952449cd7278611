# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Directional forgetting: forget only where new data come in (subspace of information forgetting).

The recent regressors span a subspace: the eigenvectors V of their mean square

    S(k) = mu S(k-1) + (1 - mu) w w^T

with eigenvalues above epsilon^2. What is shorter is noise; a sample with |w| < epsilon is left out, because noise alone
would slowly remove what is known. Before each measurement, with R = P^-1,

    R <- R - (1 - lambda) R V (V^T R V)^-1 V^T R     that is     P <- P + (1/lambda - 1) V (V^T R V)^-1 V^T

What the data do not reach is never forgotten, so P stays bounded without any excitation. Where they reach everything,
this is exponential forgetting. lambda is the smaller of a constant and of what the F test of `variable_rate` says.
(With the last regressor alone for V, as for a single measurement in the papers, a weakly excited direction is hardly
ever forgotten: two seconds after a change of the paper's plant a1 still has an error of 40 %.)

L. Cao and H. Schwartz, A directional forgetting algorithm based on the decomposition of the information matrix,
Automatica 36, 2000; B. Lai and D. S. Bernstein, SIFt-RLS, arXiv:2404.10844, 2024 (bounds on P without excitation).
"""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.ordered_dot import dot_of

from satvib_ident.covariance.eigenvalues import is_positive, rotate
from satvib_ident.covariance.ud import forget_one
from satvib_ident.forgetting.exponential import checked_factor
from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Factors
from satvib_ident.forgetting.variable_rate import VariableRateForgetting, tested_factor

# Regressors that along a direction are no longer than this many deviations of the noise hold no information on it.
DEVIATIONS = 2.0


class Setting(IntEnum):
    """Places of the settings."""

    FACTOR = 0  # lambda while nothing changes
    FADE = 1  # mu


@kernel(
    'void(f8[:], f8, b1, f8[:], f8, f8, f8[:], f8[:,:], f8[:], f8[:], f8[:], f8[:,:], f8[:], f8[:,:,:],'
    'f8[:], b1[:])',
    '(p),(),(),(c),(),(),(t),(p,p),(o),(l),(s),(p,p),(p),(k,p,p)->(),()',
    writable=('S', 'sure', 'ring', 'state', 'U', 'd'),
)
def _renew(w, error, active, settings, floor, limit, test, S, sure, ring, state, U, d, work, kept, used):  # fmt: skip
    """Move S on, and forget where it reaches.

    Args:
        w: (p) regressor.
        error: () prediction error.
        active: () bool.
        settings: (2) see `Setting`.
        floor: () epsilon^2.
        limit: () largest trace of P.
        test: settings of the F test.
        S: (p, p), the upper triangle, changed.
        sure: (1) what the smallest eigenvalue of S is proved to exceed, changed. It falls no faster than mu, so one
            proof with room to spare lasts for many samples.
        ring, state: windows of the F test, changed.
        U: (p, p), changed.
        d: (p), changed.
        work: (2, p, p), for the kernel alone; one for all items, and therefore not called writable.
        kept: () out, lambda for the measurement: 1 where S does not reach everything.
        used: () out, whether the sample is to be used.
    """
    p = w.shape[0]
    bounded = True
    for i in range(p):
        bounded = bounded and abs(w[i]) < 1e60
    used[0] = active and dot_of(w, w) >= floor
    kept[0] = 1.0
    factor = min(settings[Setting.FACTOR], tested_factor(error, used[0], test, ring, state))
    if not (used[0] and bounded):  # what `measure` would refuse must not get into S either
        return
    fade = settings[Setting.FADE]
    A, V = work[0], work[1]
    trace = 0.0
    for i in range(p):
        for j in range(i, p):
            S[i, j] = fade * S[i, j] + (1.0 - fade) * (w[i] * w[j])
        trace += S[i, i]
    least = max(floor, 1e-12 * trace)
    sure[0] *= fade
    if not sure[0] >= least:
        sure[0] = 0.0
        for room in (100.0, 1.0):
            for i in range(p):
                for j in range(i, p):
                    A[i, j] = S[i, j]
                A[i, i] -= room * least
            if is_positive(A, 1e-14 * trace):
                sure[0] = room * least
                break
    if sure[0] > 0.0:
        kept[0] = factor
        return
    if not factor < 1.0:
        return
    for i in range(p):
        for j in range(p):
            A[i, j] = S[i, j] if i <= j else S[j, i]
            V[i, j] = 1.0 if i == j else 0.0
    rotate(A, V)
    for i in range(p):
        if not A[i, i] > least:
            V[i, :] = 0.0
    forget_one(V, factor, limit, U, d, A)


class DirectionalForgetting(NoForgetting):
    """Forget in the subspace of the recent regressors.

    Args:
        factor: lambda in (0, 1] while nothing changes.
        floor: epsilon, RMS of the regressor along a direction, in its mixed units (m/s^2, V); 0: twice the deviation
            of the noise, once that is known.
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
        self._given = floor > 0.0
        self._floor = np.asarray(floor * floor)
        self._settings = np.zeros(len(Setting))
        self._settings[Setting.FACTOR] = self.factor
        self._settings[Setting.FADE] = 1.0 - 1.0 / window
        # with a rate of 0 the test never asks to forget
        self._test = test if test is not None else VariableRateForgetting(1, 1, rate=0.0)

    def bind(self, estimator: Factors) -> None:
        """Make room for S and for the windows of the test."""
        p = estimator.count
        self._S = np.zeros((*estimator.shape, p, p))
        self._sure = np.zeros((*estimator.shape, 1))
        self._work = np.zeros((2, p, p))
        self._test.bind(estimator)

    def know_noise(self, deviation: Array) -> None:
        """Take the floor from the noise (shape) unless it was given."""
        if not self._given:
            self._floor = (DEVIATIONS * deviation) ** 2

    def apply(
        self, estimator: Factors, w: Array, error: Array, active: Mask
    ) -> tuple[Array, Array, Mask]:
        """Leave out what is shorter than the floor; forget where the recent regressors reach."""
        kept, used = _renew(
            w, error, active, self._settings, self._floor, estimator.limit, self._test.settings,
            self._S, self._sure, self._test.ring, self._test.state,
            estimator.U, estimator.d, self._work,
        )  # fmt: skip
        return kept, error, used

    def reset(self, mask: Mask) -> None:
        """Empty S and the windows of the test."""
        self._S[...] = np.where(mask[..., None, None], 0.0, self._S)
        self._sure[...] = np.where(mask[..., None], 0.0, self._sure)
        self._test.reset(mask)
