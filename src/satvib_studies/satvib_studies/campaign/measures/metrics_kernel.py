# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Levels of a trial without a record of it: sums that grow with every sample, per window and strut.

For a window of N samples x_i at times t_i and tones f_1 .. f_T, with the basis p = (cos 2 pi f t, sin 2 pi f t, .., 1),

    S1 = sum x,   S2 = sum x^2,   q = sum p x,   G = sum p p'
    rms = sqrt(S2 / N - (S1 / N)^2),   w = G^-1 q,   amplitude_j = sqrt(w_2j^2 + w_2j+1^2),

which are the definitions of `analysis.levels` (least squares with a constant). Signals are taken relative to their
first value, so that a sensor's bias costs no digits. Attenuations are Eq. (42), 20 log10 of a ratio.
"""

import math

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit


@njit
def _add(value, basis, used, sums):
    """Take one value of one strut: sums are S1, S2, q."""
    sums[0] += value
    sums[1] += value * value
    for p in range(used):
        sums[2 + p] += basis[p] * value


@njit
def _used(tones):
    """Number of basis functions of the tones (NaN: none) without the constant."""
    count = 0
    while count < tones.shape[0] and not math.isnan(tones[count]):
        count += 1
    return 2 * count


@njit
def _begin(tones, t, basis):
    """Set the basis to time t."""
    for j in range(_used(tones) // 2):
        angle = 2.0 * math.pi * tones[j] * t
        basis[2 * j] = math.cos(angle)
        basis[2 * j + 1] = math.sin(angle)


@njit
def _weigh(basis, used, gram):
    """Add p p' to G (lower half), the constant last."""
    for p in range(used):
        for q in range(p + 1):
            gram[p, q] += basis[p] * basis[q]
        gram[used, p] += basis[p]
    gram[used, used] += 1.0


@kernel(
    'void(f8,f8,f8[:,:],f8[:],f8[:,:],f8[:],f8[:,:],f8[:,:,:,:],f8[:,:,:,:],f8[:])',
    '(),(),(w,b),(t),(n,f),(n),(c,n),(w,c,n,s),(w,c,p,p)->()',
    writable=('origin', 'sums', 'gram'),
)
def add_sample(k, dt, windows, tones, fine, reading, origin, sums, gram, done):
    """Take one sample of one trial into every window that holds it.

    Args:
        k: index of the sample.
        dt: s.
        windows: (w, 2) first sample and the one after the last.
        tones: (t) Hz, increasing, then NaN.
        fine, reading: (n, f), (n) truth from this sample to the next, and what the loop reads, m/s^2.
        origin: (2, n) what signals are relative to; set by the first sample of any window.
        sums: (w, 2, n, 2 + 2 t) S1, S2, q of the truth and of the readings.
        gram: (w, 2, 2 t + 1, 2 t + 1) G of both.
        done: 1 where the sample was in a window.
    """
    struts, steps = fine.shape
    used = _used(tones)
    basis = np.empty(2 * tones.shape[0])
    turn = np.empty(2 * tones.shape[0])
    done[0] = 0.0
    for w in range(windows.shape[0]):
        if k < windows[w, 0] or k >= windows[w, 1]:
            continue
        done[0] = 1.0
        if math.isnan(origin[0, 0]):
            for i in range(struts):
                origin[0, i] = fine[i, 0]
                origin[1, i] = reading[i]
        _begin(tones, (k - windows[w, 0]) * dt, basis)
        _weigh(basis, used, gram[w, 1])
        for i in range(struts):
            _add(reading[i] - origin[1, i], basis, used, sums[w, 1, i])
        _begin(tones, dt / steps, turn)
        for j in range(steps):
            _weigh(basis, used, gram[w, 0])
            for i in range(struts):
                _add(fine[i, j] - origin[0, i], basis, used, sums[w, 0, i])
            for p in range(0, used, 2):  # one fine step on
                c = basis[p] * turn[p] - basis[p + 1] * turn[p + 1]
                basis[p + 1] = basis[p + 1] * turn[p] + basis[p] * turn[p + 1]
                basis[p] = c


@njit
def _solve(gram, q, size, w):
    """Solve G w = q by Cholesky's factor of the lower half; False where G has none."""
    factor = np.zeros((size, size))
    for i in range(size):
        for j in range(i + 1):
            total = gram[i, j]
            for p in range(j):
                total -= factor[i, p] * factor[j, p]
            if i == j:
                if not total > 1e-9 * gram[i, i]:
                    return False
                factor[i, i] = math.sqrt(total)
            else:
                factor[i, j] = total / factor[j, j]
    for i in range(size):
        total = q[i]
        for p in range(i):
            total -= factor[i, p] * w[p]
        w[i] = total / factor[i, i]
    for i in range(size - 1, -1, -1):
        total = w[i]
        for p in range(i + 1, size):
            total -= factor[p, i] * w[p]
        w[i] = total / factor[i, i]
    return True


@kernel('void(f8[:],f8[:],f8[:,:],f8[:])', '(t),(s),(p,p)->()')
def tone_level(tones, sums, gram, level):
    """Amplitude of all tones together in one window, m/s^2; NaN without tones or with too short a window."""
    used = _used(tones)
    level[0] = math.nan
    if used == 0 or gram[used, used] <= used + 1:
        return
    q = np.empty(used + 1)
    w = np.zeros(used + 1)
    for p in range(used):
        q[p] = sums[2 + p]
    q[used] = sums[0]
    if _solve(gram, q, used + 1, w):
        total = 0.0
        for p in range(used):
            total += w[p] * w[p]
        level[0] = math.sqrt(total)


@kernel('void(f8[:],f8[:],f8[:,:],f8[:])', '(t),(s),(p,p)->()')
def rms_level(tones, sums, gram, level):
    """RMS without the mean in one window, m/s^2; NaN without samples."""
    count = gram[_used(tones), _used(tones)]
    level[0] = math.nan
    if count > 0.0:
        mean = sums[0] / count
        level[0] = math.sqrt(max(sums[1] / count - mean * mean, 0.0))


@kernel('void(u8[:],u8,u8[:])', '(n),()->()')
def fingerprint(bits, before, after):
    """Carry a fingerprint on over the bits of a sample's voltages (FNV-1a over 64-bit words)."""
    total = before
    for i in range(bits.shape[0]):
        total = (total ^ bits[i]) * np.uint64(1099511628211)
        total ^= total >> np.uint64(29)
    after[0] = total
