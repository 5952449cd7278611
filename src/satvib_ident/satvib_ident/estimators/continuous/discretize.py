# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""From a transfer function in s to the IIR model of its samples, batched, in plain arithmetic.

The input stands still over the period that ends with a sample, u(t) = v(k) for (k-1) dt < t <= k dt, and the sample
sees it:

    x(k) = Phi x(k-1) + Gamma v(k),   y(k) = C x(k) + D v(k)
    a: characteristic polynomial of Phi (Faddeev-LeVerrier),   b = a * (impulse response), its first n + 1 terms

In the graph v(k) = u(k-1), which is the model's delay of one sample. Phi and Gamma come from one matrix exponential
by scaling and squaring in units of dt.
"""

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel


@kernel('void(f8[:], f8[:], f8, f8[:])', '(p),(q),()->(q)')
def _discretize(theta, like, dt, out):
    n = (like.shape[0] - 1) // 2
    m = theta.shape[0] - n
    size = n + 1
    # controllable form in units of dt: alpha_i dt^i, states d^(n-1)x .. x, input joined
    E = np.zeros((size, size))
    scale = 1.0
    norm = 0.0
    for i in range(n):
        scale *= dt
        E[0, i] = -theta[i] * scale
        norm = max(norm, abs(E[0, i]))
    for i in range(1, n):
        E[i, i - 1] = 1.0
    E[0, n] = 1.0
    halvings = 0
    norm = n * norm + 1.0
    while norm > 0.5 and halvings < 60:
        norm *= 0.5
        halvings += 1
    if not norm <= 0.5:
        for i in range(out.shape[0]):
            out[i] = np.nan
        return
    factor = 0.5**halvings
    total = np.eye(size)
    term = np.eye(size)
    work = np.zeros((size, size))
    for k in range(1, 16):
        for i in range(size):
            for j in range(size):
                s = 0.0
                for r in range(size):
                    s += term[i, r] * E[r, j]
                work[i, j] = s * factor / k
        for i in range(size):
            for j in range(size):
                term[i, j] = work[i, j]
                total[i, j] += work[i, j]
    for _ in range(halvings):
        for i in range(size):
            for j in range(size):
                s = 0.0
                for r in range(size):
                    s += total[i, r] * total[r, j]
                work[i, j] = s
        for i in range(size):
            for j in range(size):
                total[i, j] = work[i, j]
    # output row: beta over s^n .. s^0, the direct part taken out; beta_j s^j carries dt^(n - j)
    full = np.zeros(n + 1)
    for j in range(m):
        full[n + 1 - m + j] = theta[n + j]
    direct = full[0]
    row = np.zeros(n)
    scale = 1.0
    for i in range(n):
        scale *= dt
        row[i] = (full[i + 1] - direct * theta[i]) * scale
    # Faddeev-LeVerrier on Phi = total[:n, :n]
    a = np.zeros(n + 1)
    a[0] = 1.0
    M = np.eye(n)
    for k in range(1, n + 1):
        trace = 0.0
        for i in range(n):
            for j in range(n):
                s = 0.0
                for r in range(n):
                    s += total[i, r] * M[r, j]
                work[i, j] = s
            trace += work[i, i]
        a[k] = -trace / k
        for i in range(n):
            for j in range(n):
                M[i, j] = work[i, j] + (a[k] if i == j else 0.0)
    # impulse response h_0 = C Gamma + D, h_i = C Phi^i Gamma
    h = np.zeros(n + 1)
    x = total[:n, n].copy()
    y = np.zeros(n)
    for k in range(n + 1):
        for i in range(n):
            h[k] += row[i] * x[i]
        for i in range(n):
            y[i] = 0.0
            for j in range(n):
                y[i] += total[i, j] * x[j]
        for i in range(n):
            x[i] = y[i]
    h[0] += direct
    for i in range(n):
        out[i] = a[i + 1]
    for k in range(n + 1):
        s = 0.0
        for i in range(k + 1):
            s += a[i] * h[k - i]
        out[n + k] = s


@kernel('void(f8[:,:], f8[:,:], f8[:,:])', '(q,p),(p,p)->(q,q)')
def _congruence(J, C, out):
    q, p = J.shape
    for a in range(q):
        for b in range(a, q):
            total = 0.0
            for i in range(p):
                for j in range(p):
                    total += J[a, i] * C[i, j] * J[b, j]
            out[a, b] = total
            out[b, a] = total


def discretize(theta: Array, poles: int, dt: float) -> Array:
    """IIR coefficients a1 ... an, b1 ... b(n+1) of a transfer function.

    Args:
        theta: (..., p) alpha_1 ... alpha_n, beta_1 ... beta_m, highest power first, m <= n + 1.
        poles: n.
        dt: s.

    Returns:
        (..., 2 n + 1); NaN where theta is not finite or much too large.
    """
    return np.asarray(_discretize(theta, np.zeros(2 * poles + 1), dt))


def discretized_covariance(theta: Array, covariance: Array, poles: int, dt: float) -> Array:
    """Covariance (..., 2 n + 1, 2 n + 1) of the IIR coefficients, by central differences.

    Args:
        theta: (..., p).
        covariance: (..., p, p).
        poles: n.
        dt: s.
    """
    # beta_j and alpha_j carry powers of 1/dt: the step follows the size that a fast plant would have
    n, p = poles, theta.shape[-1]
    power = np.concatenate([np.arange(1, n + 1), np.arange(n + 1 - (p - n), n + 1)])
    step = 1e-6 * np.maximum(np.abs(theta), 1e-2 / dt**power)
    moved = step[..., None, :] * np.eye(p)
    above = discretize(theta[..., None, :] + moved, n, dt)
    below = discretize(theta[..., None, :] - moved, n, dt)
    slope = np.swapaxes((above - below) / (2.0 * step[..., :, None]), -1, -2)
    return np.asarray(_congruence(np.ascontiguousarray(slope), covariance))
