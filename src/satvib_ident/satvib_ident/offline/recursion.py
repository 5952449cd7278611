# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The recursive estimators of the node along a whole record, in one compiled loop.

The loops call the bodies of the estimators' own kernels sample by sample, so they give the same bits as the classes do;
what is saved is the way from Python to a kernel, several for each sample.
"""

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import body, kernel
from satvib_common.kernels.deferred import njit

from satvib_ident.estimators import extended as extended_module
from satvib_ident.estimators import instrumental as instrumental_module
from satvib_ident.estimators import least_squares as least_squares_module
from satvib_ident.estimators.extended import ExtendedLeastSquares
from satvib_ident.estimators.instrumental import InstrumentalVariable
from satvib_ident.estimators.least_squares import Tally
from satvib_ident.offline.compressed import Progress, quiet

BLOCK = 50_000  # samples between two signs of life

_extend_one = body(extended_module._extend)  # noqa: SLF001
_leave_one = body(extended_module._leave)  # noqa: SLF001
_learn_one = body(least_squares_module._learn)  # noqa: SLF001
_filter_one = body(instrumental_module._filter)  # noqa: SLF001
_solve_one = body(instrumental_module._solve)  # noqa: SLF001


@njit
def _regressor(y, late, past, drive, w):
    """Form w(k) from the histories, which move on; gives whether it is full and whether y is known."""
    n, m = past.shape[0], drive.shape[0]
    for i in range(m - 1, 0, -1):
        drive[i] = drive[i - 1]
    drive[0] = late
    full = True
    for i in range(n + m):
        value = -past[i] if i < n else drive[i - n]
        known = abs(value) < np.inf
        full = full and known
        w[i] = value if known else 0.0
    known = abs(y) < np.inf
    for i in range(n - 1, 0, -1):
        past[i] = past[i - 1]
    past[0] = y if known else np.nan
    return full, known


@njit
def _extended_step(
    w, target, active, limit, theta, U, d, tally, residual, peak, extended, gain, one, flag
):
    """One update of extended least squares; `one` (4) and `flag` (1) hold the results: error, lambda, rest, used."""
    _extend_one(w, target, active, residual, theta, extended, one[0:1], flag)
    use = flag[0]
    _learn_one(extended, one[0], 1.0, limit, use, theta, U, d, tally, gain, one[1:2], flag)
    _leave_one(extended, target, theta, residual, peak, one[2:3])


@kernel(
    'void(f8[:], f8[:], f8, f8[:], f8[:,:], f8[:], f8[:], f8[:], f8[:], f8[:], f8[:], b1[:])',
    '(t),(t),(),(q),(q,q),(q),(s),(c),(o),(n),(m)->()',
    writable=('theta', 'U', 'd', 'tally', 'residual', 'peak', 'past', 'drive'),
)
def _extended_loop(y, late, limit, theta, U, d, tally, residual, peak, past, drive, done):
    p = past.shape[0] + drive.shape[0]
    w, extended, gain = np.empty(p), np.empty(theta.shape[0]), np.empty(theta.shape[0])
    one, flag = np.empty(4), np.empty(1, dtype=np.bool_)
    for k in range(y.shape[0]):
        full, known = _regressor(y[k], late[k], past, drive, w)
        if not full:
            residual[:] = 0.0
        _extended_step(
            w, y[k] if known else 0.0, full and known, limit, theta, U, d, tally, residual, peak, extended, gain, one,
            flag,
        )  # fmt: skip
    done[0] = True


@kernel(
    'void(f8[:], f8[:], f8, f8[:], f8[:], f8[:,:], f8[:], f8[:], f8[:], f8[:], f8[:], f8[:,:], f8[:], f8[:], f8[:],'
    'f8[:,:], f8[:], f8[:], f8[:,:], f8[:], f8[:], b1[:])',
    '(t),(t),(),(v),(q),(q,q),(q),(s),(c),(o),(p),(p,p),(p),(s),(p),(k,n),(h),(o),(p,r),(n),(m)->()',
    writable=(
        'helper_theta', 'helper_U', 'helper_d', 'helper_tally', 'residual', 'peak', 'theta', 'U', 'd', 'tally', 'model',
        'memory', 'uf', 'age', 'R', 'past', 'drive',
    ),
)  # fmt: skip
def _instrumental_loop(
    y, late, limits, settings, helper_theta, helper_U, helper_d, helper_tally, residual, peak, theta, U, d, tally,
    model, memory, uf, age, R, past, drive, done,
):  # fmt: skip
    p = theta.shape[0]
    q = helper_theta.shape[0]
    w, z, wf, gain = np.empty(p), np.empty(p), np.empty(p), np.empty(p)
    extended, helper_gain = np.empty(q), np.empty(q)
    one, other = np.empty(4), np.empty(4)
    flag, used, solved = (
        np.empty(1, dtype=np.bool_),
        np.empty(1, dtype=np.bool_),
        np.empty(1, dtype=np.bool_),
    )
    work = np.empty((p, p + 1))
    for k in range(y.shape[0]):
        full, known = _regressor(y[k], late[k], past, drive, w)
        if not full:
            residual[:] = 0.0
            memory[:] = 0.0
            uf[:] = 0.0
            age[0] = 0.0
        target = y[k] if known else 0.0
        _extended_step(
            w, target, full and known, limits, helper_theta, helper_U, helper_d, helper_tally, residual, peak, extended,
            helper_gain, one, flag,
        )  # fmt: skip
        latest = helper_theta[:p]
        _filter_one(
            w, target, latest, helper_tally[Tally.UPDATES], one[0], flag[0], settings, theta, model, memory, uf, age, z,
            wf, other[0:1], other[1:2], used,
        )  # fmt: skip
        use = used[0]
        _learn_one(z, other[1], one[1], limits, use, theta, U, d, tally, gain, other[2:3], used)
        _solve_one(
            z, wf, other[0], other[2], used[0], latest, tally[Tally.UPDATES], settings, theta, R, work, solved
        )  # fmt: skip
    done[0] = True


class RecordEstimator:
    """Extended least squares or the instrumental variable along one record.

    Args:
        method: 'extended' or 'instrumental'.
        poles: n.
        coefficients: m.
        delay: samples.

    Raises:
        SatvibError: another method.
    """

    def __init__(self, method: str, poles: int, coefficients: int, delay: int) -> None:
        count = poles + coefficients
        self.estimator: ExtendedLeastSquares | InstrumentalVariable
        if method == 'extended':
            self.estimator = ExtendedLeastSquares(count, poles)
        elif method == 'instrumental':
            self.estimator = InstrumentalVariable(poles, coefficients)
        else:
            raise SatvibError(f'method: {method!r} is not extended or instrumental')
        self.count, self.delay = count, delay
        self._past, self._drive = np.full(poles, np.nan), np.full(coefficients, np.nan)
        self._at = 0

    def run(self, y: Array, u: Array, end: int, progress: Progress = quiet) -> None:
        """Take the samples of a record up to `end`; (samples) arrays, NaN where a sample is missing."""
        late = np.concatenate([np.full(self.delay, np.nan), u])[: len(u)]
        e = self.estimator
        while self._at < end:
            part = slice(self._at, min(self._at + BLOCK, end))
            if isinstance(e, InstrumentalVariable):
                h = e.auxiliary
                _instrumental_loop(
                    y[part], late[part], e.limit, e._settings, h.theta, h.U, h.d, h.tally, h._residual, h._peak,  # noqa: SLF001
                    e.theta, e.U, e.d, e.tally, e.model, e._past, e._uf, e._age, e._R, self._past, self._drive,  # noqa: SLF001
                )  # fmt: skip
            else:
                _extended_loop(
                    y[part], late[part], e.limit, e.theta, e.U, e.d, e.tally, e._residual, e._peak, self._past,  # noqa: SLF001
                    self._drive,
                )  # fmt: skip
            self._at = part.stop
            progress(self._at / len(y), f'{len(self._past)} poles')

    @property
    def theta(self) -> Array:
        """Estimate of a and b, (n + m)."""
        return self.estimator.theta[: self.count].copy()

    @property
    def deviation(self) -> Array:
        """Standard deviations of a and b, (n + m)."""
        return np.sqrt(np.diagonal(self.estimator.covariance)[: self.count])
