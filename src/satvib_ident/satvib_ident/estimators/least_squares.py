# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Recursive least squares, Theorem 4.1 (Eqs. 25-27), with a choice of forgetting.

    e(k)     = y(k) - w(k)^T theta(k-1)
    K(k)     = Pb w (1 + w^T Pb w)^-1
    theta(k) = theta(k-1) + K(k) e(k)
    P(k)     = (I - K(k) w^T) Pb

where Pb is P(k-1) after forgetting (`satvib_ident.forgetting`); P is kept as U D U^T (`covariance.ud`). The
variance of the noise comes along:

    S(k) = lambda S(k-1) + e(k)^2 / (1 + w^T Pb w),   N(k) = lambda N(k-1) + 1,   s^2 = S / (N - p)

S is the least-squares sum of residuals itself (for lambda = 1, without the prior), so the covariance of theta is s^2
P.
"""

from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.ordered_dot import dot_of
from satvib_common.kernels.ud import measure_one

from satvib_ident.covariance import ud
from satvib_ident.covariance.eigenvalues import information_measures
from satvib_ident.covariance.ud import grown_scale
from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Forgetting


class Tally(IntEnum):
    """Places of the counts of an estimator."""

    UPDATES = 0  # samples used
    REFUSED = 1  # samples refused
    RESIDUALS = 2  # S(k)
    WEIGHT = 3  # N(k)


@kernel('void(f8[:], f8, b1, f8[:], f8[:], b1[:])', '(p),(),(),(p)->(),()')
def _predict(w, y, active, theta, error, use):
    """Prediction error of one sample, and whether it may be used."""
    error[0] = y - dot_of(w, theta)
    use[0] = active and abs(error[0]) < np.inf  # np.isfinite(inf) would raise a flag


@kernel(
    'void(f8[:], f8, f8, f8, b1, f8[:], f8[:,:], f8[:], f8[:], f8[:], f8[:], b1[:])',
    '(p),(),(),(),(),(p),(p,p),(p),(t)->(p),(),()',
    writable=('theta', 'U', 'd', 'tally'),
)
def _learn(w, error, forgotten, limit, use, theta, U, d, tally, gain, kept, used):
    """Eqs. (25)-(27) and the tally of one sample; gives K(k), lambda, and whether the sample was used."""
    used[0] = False
    kept[0] = 1.0
    if not use:
        gain[:] = 0.0
        return
    alpha = measure_one(w, error, grown_scale(forgotten, limit, U, d), theta, U, d, gain)
    if alpha < 0.0:
        tally[Tally.REFUSED] += 1.0
        return
    used[0] = True
    kept[0] = forgotten
    tally[Tally.UPDATES] += 1.0
    tally[Tally.RESIDUALS] = forgotten * tally[Tally.RESIDUALS] + error * error / alpha
    tally[Tally.WEIGHT] = forgotten * tally[Tally.WEIGHT] + 1.0


class RecursiveLeastSquares:
    """Theorem 4.1 for every item of `shape`.

    Args:
        count: number of parameters p.
        shape: leading axes.
        forgetting: what happens to old data; none by default.
        initial_covariance: P(0) as a scalar or (p) diagonal, per unit of noise variance. Large: the data alone
        decide. initial_theta: theta(0), (p); zeros by default.
        limit: largest trace of P that forgetting may reach; the initial trace by default.

    Attributes:
        theta: (*shape, p).
        tally: (*shape, 4) counts, see `Tally`.
        used, kept: (shape) whether the last sample was used, and its lambda.

    Raises:
        SatvibError: a count of zero, or an initial covariance that is not positive.
    """

    # whether `update` needs also the samples that are not used, because later ones build on them
    keeps_signals = False

    def __init__(
        self,
        count: int,
        shape: tuple[int, ...] = (),
        forgetting: Forgetting | None = None,
        initial_covariance: ArrayLike = 1e18,
        initial_theta: ArrayLike = 0.0,
        limit: float = 0.0,
    ) -> None:
        if count < 1:
            raise SatvibError(f'estimator: {count} parameters; at least one is needed')
        self._P0 = np.broadcast_to(np.asarray(initial_covariance, dtype=float), (count,)).copy()
        if not (np.isfinite(self._P0).all() and (self._P0 > 0.0).all()):
            raise SatvibError(f'initial_covariance: {self._P0.tolist()} is not positive')
        theta = np.asarray(initial_theta, dtype=float)
        if theta.size not in {1, count} or not np.isfinite(theta).all():
            raise SatvibError(f'initial_theta: {count} finite numbers are expected')
        self._theta0 = np.broadcast_to(theta, (count,)).copy()
        self.count, self.shape = count, shape
        self.limit = np.asarray(limit if limit > 0.0 else self._P0.sum())
        self.forgetting: Forgetting = forgetting if forgetting is not None else NoForgetting()
        self.theta = np.broadcast_to(self._theta0, (*shape, count)).copy()
        self.U, self.d = ud.fresh(self._P0, shape)
        self.error_scale: Array | float = 1.0
        self.tally = np.zeros((*shape, len(Tally)))
        self.forgetting.bind(self)

    def update(self, w: Array, y: Array, active: Mask | bool = True) -> Array:
        """Take one sample.

        Args:
            w: (*shape, p) regressor; finite where `active`.
            y: (shape) output.
            active: (shape) whether to use the sample.

        Returns:
            Prediction error (shape), before the update, also where inactive.
        """
        error, use = _predict(w, y, active, self.theta)
        self.correct(w, error, use)
        return np.asarray(error)

    def correct(self, w: Array, error: Array, use: Mask) -> None:
        """Update along `w` (*shape, p) for an error (shape) made elsewhere, finite where `use` (shape) holds."""
        forgotten, error, use = self.forgetting.apply(self, w, error, use)
        self.learn(w, error, forgotten, use)

    def learn(self, w: Array, error: Array, forgotten: Array, use: Mask) -> None:
        """Eqs. (25)-(27) and the sum of residuals, after forgetting."""
        _, self.kept, self.used = _learn(
            w, error, forgotten, self.limit, use, self.theta, self.U, self.d, self.tally
        )

    def count_samples(self, used: Mask, refused: Mask) -> None:
        """Count samples (shape) that were used or refused without `learn`."""
        self.tally[..., Tally.UPDATES] += used
        self.tally[..., Tally.REFUSED] += refused

    @property
    def updates(self) -> Array:
        """Samples used, (shape)."""
        return self.tally[..., Tally.UPDATES].copy()

    @property
    def refused(self) -> Array:
        """Samples refused because they were too large to square, (shape)."""
        return self.tally[..., Tally.REFUSED].copy()

    @property
    def P(self) -> Array:  # noqa: N802
        """Covariance per unit of noise variance, (*shape, p, p), symmetric to the last bit."""
        return ud.covariance(self.U, self.d)

    @property
    def noise_variance(self) -> Array:
        """Estimated variance of the prediction error, (shape); NaN until there are more samples than parameters."""
        freedom = self.tally[..., Tally.WEIGHT] - self.count
        if not freedom.ndim:  # one strut: without NumPy's way of choosing
            residuals = self.tally[Tally.RESIDUALS]
            return np.asarray(residuals / freedom if freedom > 0.0 else np.nan)
        known = freedom > 0.0
        return np.where(
            known, self.tally[..., Tally.RESIDUALS] / np.where(known, freedom, 1.0), np.nan
        )

    @property
    def covariance(self) -> Array:
        """Covariance of theta, (*shape, p, p): the noise variance times P."""
        return np.asarray(self.noise_variance)[..., None, None] * self.P

    def information(self) -> tuple[Array, Array]:
        """Smallest eigenvalue and condition of the normalized information matrix, (shape) each."""
        return information_measures(self.U, self.d)

    def reset(self, mask: Mask | bool = True) -> None:
        """Start again where `mask` (shape) holds: theta(0), P(0), no memory."""
        mask = np.asarray(mask)
        self.theta[...] = np.where(mask[..., None], self._theta0, self.theta)
        self.reset_covariance(mask)
        for place in (Tally.UPDATES, Tally.RESIDUALS, Tally.WEIGHT):
            self.tally[..., place] = np.where(mask, 0.0, self.tally[..., place])
        self.forgetting.reset(mask)

    def reset_covariance(self, mask: Mask | bool = True) -> None:
        """P <- P(0) where `mask` (shape) holds; the estimate stays."""
        mask = np.asarray(mask)
        self.U[...] = np.where(mask[..., None, None], np.eye(self.count), self.U)
        self.d[...] = np.where(mask[..., None], self._P0, self.d)

    def interrupt(self, mask: Mask | bool = True) -> None:
        """Note a break in the samples where `mask` holds; least squares keeps no signals."""
