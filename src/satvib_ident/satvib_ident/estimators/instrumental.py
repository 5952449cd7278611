# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Recursive instrumental variable: what correlates with the input, and not with the noise, decides.

An auxiliary model turns the input into an output x(k) without noise. The model is the plant of a recursive extended
least-squares estimator that runs beside this one. That estimator takes nothing from here, so there is no feedback that
could diverge. Its 1/A(q) filters all signals, so that the error of an output with white noise is white:

    z = [-x_f(k-1) ... -x_f(k-n), u_f(k-d) ...],   w_f = [-y_f(k-1) ..., u_f(k-d) ...]
    R(k) = lambda R(k-1) + z w_f^T,   r(k) = lambda r(k-1) + z y_f,   R theta = r

E z (y_f - w_f^T theta) = 0 holds for the true plant whatever the colour of the noise. Unlike recursions with a
symmetric gain it needs no z close to w_f: those diverge on lightly damped plants until the auxiliary model is good.
P = (sum z z^T)^-1 is kept as U D U^T, and s^2 P is the covariance of the estimate. The first samples are those of
extended least squares.

P. C. Young, Recursive Estimation and Time-Series Analysis, 2011, chapter 7; T. Soederstroem and P. Stoica, System
Identification, 1989, chapter 8.
"""

from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.ordered_dot import dot_of

from satvib_ident.estimators.extended import ExtendedLeastSquares
from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.forgetting.protocol import Forgetting
from satvib_ident.models.polynomials import inside

STABLE = (
    0.995  # an auxiliary model with poles beyond this radius would keep its own errors for too long
)


class Setting(IntEnum):
    """Places of the settings."""

    WARM_UP = 0  # samples before the estimate is that of the instrumental variable
    SETTLE = 1  # samples after a break that are not used


class Past(IntEnum):
    """Rows of the past signals."""

    OUTPUT = 0  # x, of the auxiliary model
    FILTERED = 1  # x_f
    MEASURED = 2  # y_f


@kernel(
    'void(f8[:], f8, f8[:], f8, f8, b1, f8[:], f8[:], f8[:], f8[:,:], f8[:], f8[:],'
    'f8[:], f8[:], f8[:], f8[:], b1[:])',
    '(p),(),(p),(),(),(),(c),(p),(p),(k,n),(h),(s)->(p),(p),(),(),()',
    writable=('model', 'past', 'uf', 'age'),
)
def _filter(
    w, y, latest, helper, first, helped, settings, theta, model, past, uf, age, z, wf, yf, error, use
):  # fmt: skip
    """Form z, w_f, y_f and the prediction error of one sample, and whether it may be used.

    Args:
        w: (p) regressor.
        y: () output; one that is not finite breaks the signals.
        latest: (p) estimate of the auxiliary estimator.
        helper: () samples that it has used.
        first: () its prediction error.
        helped: () whether it has used the sample.
        settings: (2) see `Setting`.
        theta: (p) estimate.
        model: (p) last auxiliary model that was stable, changed.
        past: (3, n) see `Past`, the newest first, changed.
        uf: (max(n, m)) filtered input, changed.
        age: (1) samples since the last break, changed.
        z, wf, yf: (p), (p), () out.
        error: () out; that of the auxiliary estimator during the warm-up.
        use: () out.
    """
    n = past.shape[1]
    p = w.shape[0]
    known = abs(y) < np.inf
    if not known:
        for i in range(n):
            past[:, i] = 0.0
        for j in range(uf.shape[0]):
            uf[j] = 0.0
        age[0] = 0.0
    good = inside(latest[:n], STABLE)
    for i in range(p):
        good = good and abs(latest[i]) < 1e50
    if good:
        for i in range(p):
            model[i] = latest[i]
    u = w[n]
    new_y = y if known else 0.0
    new_x = 0.0
    for i in range(n):
        u -= model[i] * uf[i]
        new_y -= model[i] * past[Past.MEASURED, i]
        new_x -= model[i] * past[Past.OUTPUT, i]
    for j in range(uf.shape[0] - 1, 0, -1):
        uf[j] = uf[j - 1]
    uf[0] = u
    for i in range(n):
        z[i] = -past[Past.FILTERED, i]
        wf[i] = -past[Past.MEASURED, i]
    for i in range(n, p):
        z[i] = uf[i - n]
        wf[i] = uf[i - n]
        new_x += model[i] * w[i]
    filtered = new_x
    for i in range(n):
        filtered -= model[i] * past[Past.FILTERED, i]
    if not (abs(new_x) < 1e100 and abs(filtered) < 1e100 and abs(new_y) < 1e100):
        new_x, filtered, new_y = 0.0, 0.0, 0.0
    for i in range(n - 1, 0, -1):
        past[:, i] = past[:, i - 1]
    past[Past.OUTPUT, 0] = new_x
    past[Past.FILTERED, 0] = filtered
    past[Past.MEASURED, 0] = new_y
    yf[0] = new_y
    length = 0.0
    for i in range(p):
        length += z[i] * z[i] + wf[i] * wf[i]
    rest = new_y - dot_of(wf, theta)
    late = helper >= settings[Setting.WARM_UP]
    use[0] = (
        helped
        and late
        and age[0] >= settings[Setting.SETTLE]
        and abs(rest) < 1e100
        and length < 1e200
    )
    error[0] = rest if late else first
    age[0] += 1.0


@njit(inline='always')
def _eliminate(A, bound):
    """Solve the system (p, p + 1) by elimination with threshold pivots on equilibrated rows.

    The last column becomes theta. Gives False where the system is singular or the solution is larger than `bound`.
    """
    p = A.shape[0]
    for i in range(p):
        largest = 0.0
        for j in range(p):
            largest = max(largest, abs(A[i, j]))
        if not 0.0 < largest < 1e280:
            return False
        scale = 1.0 / largest
        for j in range(p + 1):
            A[i, j] *= scale
    for k in range(p):
        largest = 0.0
        for i in range(k, p):
            largest = max(largest, abs(A[i, k]))
        if not largest > 1e-13:
            return False
        if abs(A[k, k]) < 0.1 * largest:  # R is nearly symmetric, so this is seldom
            pivot = k
            for i in range(k + 1, p):
                if abs(A[i, k]) > abs(A[pivot, k]):
                    pivot = i
            for j in range(k, p + 1):
                A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
        inverse = 1.0 / A[k, k]
        A[k, k] = inverse
        for i in range(k + 1, p):
            factor = A[i, k] * inverse
            for j in range(k + 1, p + 1):
                A[i, j] -= factor * A[k, j]
    for i in range(p - 1, -1, -1):
        for j in range(i + 1, p):
            A[i, p] -= A[i, j] * A[j, p]
        A[i, p] *= A[i, i]
        if not abs(A[i, p]) < bound:
            return False
    return True


@kernel(
    'void(f8[:], f8[:], f8, f8, b1, f8[:], f8, f8[:], f8[:], f8[:,:], f8[:,:], b1[:])',
    '(p),(p),(),(),(),(p),(),(c),(p),(p,q),(p,q)->()',
    writable=('theta', 'R'),
)
def _solve(z, wf, yf, kept, used, latest, updates, settings, theta, R, work, solved):
    """Add a sample to [R r] (p, p + 1) and solve R theta = r.

    `latest` is the estimate until the warm-up is over (`updates` counts its samples). Where R is singular, or the
    solution is a million times larger than the estimate before, that stays. `work` is one for all items.
    """
    p = theta.shape[0]
    solved[0] = False
    if used:
        for i in range(p):
            for j in range(p):
                R[i, j] = kept * R[i, j] + z[i] * wf[j]
            R[i, p] = kept * R[i, p] + z[i] * yf
    if updates < settings[Setting.WARM_UP]:
        theta[:] = latest
    elif used:
        bound = 1.0
        for i in range(p):
            bound = max(bound, abs(theta[i]))
            for j in range(p + 1):
                work[i, j] = R[i, j]
        solved[0] = _eliminate(work, 1e6 * bound)
        if solved[0]:
            for i in range(p):
                theta[i] = work[i, p]


class InstrumentalVariable(RecursiveLeastSquares):
    """Instrumental variable with n poles and m coefficients; theta is (*shape, n + m).

    Args:
        poles: n.
        coefficients: m.
        noise: coefficients of the noise model of the auxiliary estimator; n by default.
        shape: leading axes.
        forgetting: what happens to old data; a rule that only chooses lambda or leaves samples out.
        initial_covariance: diagonal of P(0).
        initial_theta: theta(0), (n + m) or a scalar.
        limit: largest trace of P that forgetting may reach.
        warm_up: samples before the auxiliary model is used, and again before the estimate is; 6 (n + m) by default.
        settle: samples left out after a break, until the filters have forgotten it.

    Attributes:
        auxiliary: the extended least-squares estimator.
    """

    keeps_signals = True

    def __init__(
        self,
        poles: int,
        coefficients: int,
        noise: int = 0,
        shape: tuple[int, ...] = (),
        forgetting: Forgetting | None = None,
        initial_covariance: float = 1e18,
        initial_theta: ArrayLike = 0.0,
        limit: float = 0.0,
        warm_up: int = 0,
        settle: int = 20,
    ) -> None:
        count = poles + coefficients
        super().__init__(count, shape, None, initial_covariance, initial_theta, limit)
        self.auxiliary = ExtendedLeastSquares(
            count, noise or poles, shape, forgetting, initial_covariance, initial_theta, limit
        )
        self.poles = poles
        self.warm_up, self.settle = warm_up or 6 * count, settle
        self.model = np.zeros((*shape, count))
        self._R = np.zeros((*shape, count, count + 1))
        self._work = np.zeros((count, count + 1))
        self._past = np.zeros((*shape, len(Past), poles))
        self._uf = np.zeros((*shape, max(poles, coefficients)))
        self._age = np.zeros((*shape, 1))
        self._settings = np.zeros(len(Setting))
        self._settings[Setting.WARM_UP] = self.warm_up
        self._settings[Setting.SETTLE] = self.settle

    def update(self, w: Array, y: Array, active: Mask | bool = True) -> Array:
        """Take one sample; the error is y_f - w_f^T theta: y minus the output of the model alone."""
        helper, settings = self.auxiliary, self._settings
        first = helper.update(w, y, active)
        latest = helper.theta[..., : self.count]
        z, wf, yf, error, use = _filter(
            w, y, latest, helper.updates, first, helper.used, settings, self.theta,
            self.model, self._past, self._uf, self._age,
        )  # fmt: skip
        self.learn(z, error, helper.kept, use)
        _solve(
            z, wf, yf, self.kept, self.used, latest, self.updates, settings,
            self.theta, self._R, self._work,
        )  # fmt: skip
        return np.asarray(error)

    def interrupt(self, mask: Mask | bool = True) -> None:
        """Empty the filters where `mask` (shape) holds."""
        where = np.asarray(mask)[..., None]
        self.auxiliary.interrupt(mask)
        self._past[...] = np.where(where[..., None], 0.0, self._past)
        self._uf[...] = np.where(where, 0.0, self._uf)
        self._age[...] = np.where(where, 0.0, self._age)

    def reset(self, mask: Mask | bool = True) -> None:
        """Start again where `mask` (shape) holds."""
        super().reset(mask)
        self.auxiliary.reset(mask)
        where = np.asarray(mask)
        self.model[...] = np.where(where[..., None], 0.0, self.model)
        self._R[...] = np.where(where[..., None, None], 0.0, self._R)
        self.interrupt(mask)
