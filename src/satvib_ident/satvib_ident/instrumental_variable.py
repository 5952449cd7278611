# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Recursive instrumental variable: what correlates with the input, and not with the noise, decides.

An auxiliary model turns the input into an output x(k) that knows nothing of the noise. It is the plant of a recursive
extended least-squares estimator that runs along; nothing flows back from here to it, so it cannot run away. Its
1/A(q) filters all signals, which makes the error of an output with white noise white:

    z = [-x_f(k-1) ... -x_f(k-n), u_f(k-d) ...],   w_f = [-y_f(k-1) ..., u_f(k-d) ...]
    R(k) = lambda R(k-1) + z w_f^T,   r(k) = lambda r(k-1) + z y_f,   R theta = r

E z (y_f - w_f^T theta) = 0 holds for the true plant whatever the colour of the noise. Unlike recursions with a
symmetric gain it needs no z close to w_f: those diverge on lightly damped plants until the auxiliary model is good.
P = (sum z z^T)^-1 is kept as U D U^T, and s^2 P is the covariance of the estimate. The first samples are those of
extended least squares.

P. C. Young, Recursive Estimation and Time-Series Analysis, 2011, chapter 7; T. Soederstroem and P. Stoica, System
Identification, 1989, chapter 8.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from satvib_common.kernel import kernel

from satvib_ident import ud
from satvib_ident.extended_least_squares import ExtendedLeastSquares
from satvib_ident.forgetting import Forgetting
from satvib_ident.polynomials import pole_modulus
from satvib_ident.recursive_least_squares import RecursiveLeastSquares

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

STABLE = 0.995  # an auxiliary model beyond this radius would remember its own mistakes for too long


@kernel(
    'void(f8[:], f8, f8[:], f8[:], f8[:], f8[:], f8[:], f8[:], f8[:], f8[:])',
    '(p),(),(p),(n),(n),(n),(h)->(p),(p),()',
    writable=('x', 'xf', 'yf', 'uf'),
)
def _filter(w, y, model, x, xf, yf, uf, z, wf, out):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Form z, w_f and y_f of one sample; move the histories x, x_f, y_f (n) and u_f (max(n, m)) on."""
    n = x.shape[0]
    m = w.shape[0] - n
    u = w[n]
    new_y = y
    new_x = 0.0
    for i in range(n):
        u -= model[i] * uf[i]
        new_y -= model[i] * yf[i]
        new_x -= model[i] * x[i]
    for j in range(uf.shape[0] - 1, 0, -1):
        uf[j] = uf[j - 1]
    uf[0] = u
    for i in range(n):
        z[i] = -xf[i]
        wf[i] = -yf[i]
    for j in range(m):
        z[n + j] = uf[j]
        wf[n + j] = uf[j]
        new_x += model[n + j] * w[n + j]
    filtered = new_x
    for i in range(n):
        filtered -= model[i] * xf[i]
    if not (abs(new_x) < 1e100 and abs(filtered) < 1e100 and abs(new_y) < 1e100):
        new_x, filtered, new_y = 0.0, 0.0, 0.0
    for i in range(n - 1, 0, -1):
        x[i] = x[i - 1]
        xf[i] = xf[i - 1]
        yf[i] = yf[i - 1]
    x[0] = new_x
    xf[0] = filtered
    yf[0] = new_y
    out[0] = new_y


@kernel('void(f8[:,:], f8[:], f8[:], f8[:,:], f8[:], b1[:])', '(p,p),(p),(p)->(p,p),(p),()')
def _solve(R, r, otherwise, work, theta, good):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Solve R theta = r by elimination with row pivots on equilibrated rows.

    Where R is singular, or the solution a million times larger than `otherwise`, that is kept.
    """
    p = r.shape[0]
    good[0] = True
    bound = 1.0
    for i in range(p):
        bound = max(bound, abs(otherwise[i]))
    for i in range(p):
        largest = 0.0
        for j in range(p):
            work[i, j] = R[i, j]
            largest = max(largest, abs(R[i, j]))
        if not 0.0 < largest < 1e280:
            good[0] = False
            largest = 1.0
        theta[i] = r[i] / largest
        for j in range(p):
            work[i, j] /= largest
    for k in range(p):
        if not good[0]:
            break
        pivot = k
        for i in range(k + 1, p):
            if abs(work[i, k]) > abs(work[pivot, k]):
                pivot = i
        if not abs(work[pivot, k]) > 1e-13:
            good[0] = False
            break
        if pivot != k:
            for j in range(p):
                work[k, j], work[pivot, j] = work[pivot, j], work[k, j]
            theta[k], theta[pivot] = theta[pivot], theta[k]
        for i in range(k + 1, p):
            factor = work[i, k] / work[k, k]
            for j in range(k, p):
                work[i, j] -= factor * work[k, j]
            theta[i] -= factor * theta[k]
    if good[0]:
        for i in range(p - 1, -1, -1):
            for j in range(i + 1, p):
                theta[i] -= work[i, j] * theta[j]
            theta[i] /= work[i, i]
            if not abs(theta[i]) < 1e6 * bound:
                good[0] = False
    if not good[0]:
        for i in range(p):
            theta[i] = otherwise[i]


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
        self._R = np.zeros((*shape, count, count))
        self._r = np.zeros((*shape, count))
        self._x, self._xf, self._yf = np.zeros((3, *shape, poles))
        self._uf = np.zeros((*shape, max(poles, coefficients)))
        self._age = np.zeros(shape)

    def update(self, w: Array, y: Array, active: Mask | bool = True) -> Array:
        """Take one sample; the error is y_f - w_f^T theta: y minus the output of the model alone."""
        known = np.isfinite(y)
        if not known.all():
            self.interrupt(~known)
            y, active = np.where(known, y, 0.0), active & known
        helper = self.auxiliary
        first = helper.update(w, y, active)
        latest = helper.theta[..., : self.count]
        stable = pole_modulus(latest[..., : self.poles]) < STABLE
        stable = stable & (np.maximum.reduce(np.abs(latest), axis=-1) < 1e50)
        self.model[...] = np.where(stable[..., None], latest, self.model)
        z, wf, yf = _filter(w, y, self.model, self._x, self._xf, self._yf, self._uf)
        late = helper.updates >= self.warm_up
        use = helper.used & late & (self._age >= self.settle)
        self._age = self._age + 1.0
        error: Array = yf - ud.dot(wf, self.theta)
        use = use & (np.abs(error) < 1e100) & (ud.dot(z, z) + ud.dot(wf, wf) < 1e200)
        self._measure(z, np.where(use, error, 0.0), helper.kept, use)
        self._add(z, wf, yf, helper.kept)
        ready = (self.updates >= self.warm_up)[..., None]
        otherwise = np.where(ready, self.theta, latest)
        _, solved, _ = _solve(self._R, self._r, otherwise)
        self.theta[...] = np.where(ready, solved, latest)
        return np.where(late, error, first)

    def _add(self, z: Array, wf: Array, yf: Array, kept: Array) -> None:
        used = self.used
        kept = np.where(used, kept, 1.0)
        z = np.where(used[..., None], z, 0.0)
        self._R[...] = kept[..., None, None] * self._R + z[..., :, None] * wf[..., None, :]
        self._r[...] = kept[..., None] * self._r + z * np.where(used, yf, 0.0)[..., None]

    def interrupt(self, mask: Mask | bool = True) -> None:
        """Empty the filters where `mask` (shape) holds."""
        where = np.asarray(mask)
        self.auxiliary.interrupt(mask)
        for history in (self._x, self._xf, self._yf, self._uf):
            history[...] = np.where(where[..., None], 0.0, history)
        self._age = np.where(where, 0.0, self._age)

    def reset(self, mask: Mask | bool = True) -> None:
        """Begin anew where `mask` (shape) holds."""
        super().reset(mask)
        self.auxiliary.reset(mask)
        where = np.asarray(mask)
        self.model[...] = np.where(where[..., None], 0.0, self.model)
        self._R[...] = np.where(where[..., None, None], 0.0, self._R)
        self._r[...] = np.where(where[..., None], 0.0, self._r)
        self.interrupt(mask)
