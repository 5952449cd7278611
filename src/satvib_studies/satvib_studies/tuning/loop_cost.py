# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What gains do to one linear plant, by frequency: levels, voltage, modulus margin and stability.

With L = P C, S = (I + L)^-1, P from voltages to readings, C = T diag(c_m) T^-1 the modal law,
c_m = G_d + G_p H + G_i H^2, and one disturbance d of power spectrum W:

    u = -C S P_d d,    q = T^-1 (G_d d + G_u u),    RMS^2 = sum over frequencies of |.|^2 W

Sensor noise n adds u = -C S n. The modulus margin is the least singular value of I + L over all frequencies. The
open loop is stable, so the closed one is when the phase of det(I + L) comes back to where it began.

One kernel, one item per set of gains and plant: a whole swarm on all plants is one call.
"""

import math
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

_SQUARINGS = 10


class LoopFigure(IntEnum):
    """Places of the result."""

    TILT = 0  # rad m, of the line of sight; divide by the radius at which turns are counted
    VOLTS = 1  # V, the largest RMS of a voltage
    MARGIN = 2  # modulus margin
    TURNS = 3  # turns of the phase; 0 when the closed loop is stable
    MODES = 4  # m/s^2, RMS of the first mode; the other modes follow


@njit
def _invert(m: Any, out: Any) -> Any:
    """Invert a small complex matrix by Gauss and Jordan with pivots; `m` is spent. Gives the determinant."""
    n = m.shape[0]
    det = 1.0 + 0.0j
    for i in range(n):
        for j in range(n):
            out[i, j] = 1.0 if i == j else 0.0
    for c in range(n):
        best = c
        for r in range(c + 1, n):
            if abs(m[r, c]) > abs(m[best, c]):
                best = r
        if best != c:
            det = -det
            for j in range(n):
                m[c, j], m[best, j] = m[best, j], m[c, j]
                out[c, j], out[best, j] = out[best, j], out[c, j]
        pivot = m[c, c]
        det *= pivot
        if abs(pivot) == 0.0:
            return det
        for j in range(n):
            m[c, j] /= pivot
            out[c, j] /= pivot
        for r in range(n):
            if r != c:
                factor = m[r, c]
                for j in range(n):
                    m[r, j] -= factor * m[c, j]
                    out[r, j] -= factor * out[c, j]
    return det


@njit
def _largest_by_powers(s: Any) -> float:
    """Largest singular value of a matrix, at most 1e-4 too low.

    The largest column of g^1024, g = s^H s, is nearly the eigenvector; its Rayleigh quotient misses the eigenvalue by
    at most (1 - r) r^2048 of it, r the ratio of the next one, which is below 2e-4 for every r.
    """
    n = s.shape[0]
    g = np.zeros((n, n), dtype=np.complex128)
    for i in range(n):
        for j in range(n):
            for k in range(n):
                g[i, j] += s[k, i].conjugate() * s[k, j]
    power, square = g.copy(), np.empty((n, n), dtype=np.complex128)
    for _ in range(_SQUARINGS):
        trace = 0.0
        for i in range(n):
            trace += power[i, i].real
        if not trace > 1e-300:
            return 0.0
        for i in range(n):
            for j in range(n):
                total = 0.0j
                for k in range(n):
                    total += power[i, k] * power[k, j] / trace
                square[i, j] = total / trace
        power[:] = square
    best = 0
    for i in range(1, n):
        if power[i, i].real > power[best, best].real:
            best = i
    above, below = 0.0, 0.0
    for i in range(n):
        moved = 0.0j
        for k in range(n):
            moved += g[i, k] * power[k, best]
        above += (power[i, best].conjugate() * moved).real
        below += power[i, best].real ** 2 + power[i, best].imag ** 2
    return math.sqrt(above / below)


@njit
def _largest(s: Any) -> float:
    """Largest singular value of a matrix: of one or three rows in closed form, else by powers of s^H s."""
    n = s.shape[0]
    if n == 1:
        return abs(s[0, 0])
    if n != 3:
        return _largest_by_powers(s)
    d = np.zeros(3)
    o = np.zeros(3, dtype=np.complex128)
    for k in range(n):
        for i in range(3):
            d[i] += s[k, i].real ** 2 + s[k, i].imag ** 2
        o[0] += s[k, 0].conjugate() * s[k, 1]
        o[1] += s[k, 0].conjugate() * s[k, 2]
        o[2] += s[k, 1].conjugate() * s[k, 2]
    off = abs(o[0]) ** 2 + abs(o[1]) ** 2 + abs(o[2]) ** 2
    mean = (d[0] + d[1] + d[2]) / 3.0
    a, b, c = d[0] - mean, d[1] - mean, d[2] - mean
    spread = math.sqrt((a * a + b * b + c * c + 2.0 * off) / 6.0)
    if spread <= 1e-300:
        return math.sqrt(mean)
    det = a * b * c + 2.0 * (o[0] * o[2] * o[1].conjugate()).real
    det -= a * abs(o[2]) ** 2 + b * abs(o[1]) ** 2 + c * abs(o[0]) ** 2
    r = min(max(0.5 * det / spread**3, -1.0), 1.0)
    return math.sqrt(mean + 2.0 * spread * math.cos(math.acos(r) / 3.0))


class _Room(NamedTuple):
    """What the sums of one line are made in: I + L, S and C S (n, n); voltages and accelerations (n)."""

    M: Any
    S: Any
    CS: Any
    u: Any
    a: Any


@njit
def _room(n):
    return _Room(
        np.empty((n, n), dtype=np.complex128),
        np.empty((n, n), dtype=np.complex128),
        np.empty((n, n), dtype=np.complex128),
        np.empty(n, dtype=np.complex128),
        np.empty(n, dtype=np.complex128),
    )


@njit
def _add_line(
    C, room, read_voltage, true_voltage, read_source, true_source, power, noise, omega, mode, tilting, volts,
    figures,
):  # fmt: skip
    """Add one line to the figures and to the mean squares of the voltages; gives det(I + L) and the margin there.

    Args:
        C: (n, n) the law, u = -C y.
        room: for intermediate results.
        read_voltage, true_voltage, read_source, true_source: at this line.
        power, noise, omega: at this line.
        mode: (m, n) T^-1.
        tilting: (m) 1 where a mode tilts the line of sight, else 0.
        volts: (n) changed, V^2.
        figures: changed.
    """
    n, modes, inputs = mode.shape[1], mode.shape[0], power.shape[0]
    M, S, CS, u, a = room.M, room.S, room.CS, room.u, room.a
    for i in range(n):
        for j in range(n):
            total = 0.0j
            for k in range(n):
                total += read_voltage[i, k] * C[k, j]
            M[i, j] = total + (1.0 if i == j else 0.0)
    det = _invert(M, S)
    margin = 1.0 / max(_largest(S), 1e-300)
    loud = noise > 0.0
    for e in range(inputs):
        loud = loud or power[e] > 0.0
    if not loud:
        return det, margin
    for i in range(n):
        for j in range(n):
            total = 0.0j
            for k in range(n):
                total += C[i, k] * S[k, j]
            CS[i, j] = -total
    for e in range(inputs + n):
        # the disturbances first, then the noise of each sensor
        weight = power[e] if e < inputs else noise
        if weight == 0.0:
            continue
        for i in range(n):
            u[i] = CS[i, e - inputs] if e >= inputs else 0.0
            if e < inputs:
                for k in range(n):
                    u[i] += CS[i, k] * read_source[k, e]
            volts[i] += weight * (u[i].real ** 2 + u[i].imag ** 2)
        for i in range(n):
            a[i] = true_source[i, e] if e < inputs else 0.0
            for k in range(n):
                a[i] += true_voltage[i, k] * u[k]
        for m in range(modes):
            q = 0.0j
            for i in range(n):
                q += mode[m, i] * a[i]
            level = weight * (q.real**2 + q.imag**2)
            figures[LoopFigure.MODES + m] += level
            if tilting[m] > 0.0:
                figures[LoopFigure.TILT] += level / omega**4
    return det, margin


@njit
def _turn(now, before):
    """Angle from one value of the determinant to the next, rad."""
    turned = now * before.conjugate()
    return math.atan2(turned.imag, turned.real)


@njit
def _finish(figures, volts, margin, phase):
    """Turn the sums into figures."""
    figures[LoopFigure.TILT] = math.sqrt(figures[LoopFigure.TILT])
    for i in range(LoopFigure.MODES, figures.shape[0]):
        figures[i] = math.sqrt(figures[i])
    largest = 0.0
    for i in range(volts.shape[0]):
        largest = max(largest, volts[i])
    figures[LoopFigure.VOLTS] = math.sqrt(largest)
    figures[LoopFigure.MARGIN] = margin
    figures[LoopFigure.TURNS] = phase / math.pi


@kernel(
    'void(f8[:,:],c16[:,:,:],c16[:,:,:],c16[:,:,:],c16[:,:,:],f8[:,:],f8[:],f8[:],c16[:],f8[:,:],'
    'f8[:,:],f8[:],f8[:],f8[:])',
    '(g,m),(f,n,n),(f,n,n),(f,n,e),(f,n,e),(f,e),(f),(f),(f),(n,m),(m,n),(m),(r)->(r)',
)
def loop_figures(
    gains: Any,
    read_voltage: Any,
    true_voltage: Any,
    read_source: Any,
    true_source: Any,
    power: Any,
    noise: Any,
    omega: Any,
    integrator: Any,
    strut: Any,
    mode: Any,
    tilting: Any,
    like: Any,
    figures: Any,
) -> None:
    """Judge one set of gains on one plant.

    Args:
        gains: rows P, I, D by mode.
        read_voltage, true_voltage, read_source, true_source: as `RigResponse` has them.
        power: of each disturbance at each frequency, (m/s^2)^2 and N^2.
        noise: of a sensor at each frequency, (m/s^2)^2.
        omega: rad/s.
        integrator: H.
        strut: T.
        mode: T^-1.
        tilting: of each mode, 1 where it tilts the line of sight, else 0.
        like: only its length counts, that of the result.
        figures: `LoopFigure`.
    """
    n, modes, lines = strut.shape[0], strut.shape[1], omega.shape[0]
    for i in range(like.shape[0]):
        figures[i] = 0.0
    C = np.empty((n, n), dtype=np.complex128)
    room, volts = _room(n), np.zeros(n)
    margin, phase, before = 1e300, 0.0, 1.0 + 0.0j
    for f in range(lines):
        H = integrator[f]
        for i in range(n):
            for j in range(n):
                C[i, j] = 0.0
        for m in range(modes):
            c = gains[2, m] + gains[0, m] * H + gains[1, m] * H * H
            for i in range(n):
                for j in range(n):
                    C[i, j] += strut[i, m] * c * mode[m, j]
        det, least = _add_line(
            C, room, read_voltage[f], true_voltage[f], read_source[f], true_source[f], power[f], noise[f], omega[f],
            mode,
            tilting,
            volts,
            figures,
        )  # fmt: skip
        margin = min(margin, least)
        phase += _turn(det, before)
        before = det
    _finish(figures, volts, margin, phase)


@kernel(
    'void(c16[:,:,:],c16[:,:,:],c16[:,:,:],c16[:,:,:],c16[:,:,:],f8[:,:],f8[:],f8[:],f8[:,:],f8[:],f8[:],f8[:])',
    '(f,n,n),(f,n,n),(f,n,n),(f,n,e),(f,n,e),(f,e),(f),(f),(m,n),(m),(r)->(r)',
)
def controller_figures(
    controller: Any,
    read_voltage: Any,
    true_voltage: Any,
    read_source: Any,
    true_source: Any,
    power: Any,
    noise: Any,
    omega: Any,
    mode: Any,
    tilting: Any,
    like: Any,
    figures: Any,
) -> None:
    """Judge one controller of any kind, C at each frequency, on one plant; the others are those of `loop_figures`.

    The turns of the phase tell stability only where the controller is stable and the lines are close to each other.
    """
    n, lines = mode.shape[1], omega.shape[0]
    for i in range(like.shape[0]):
        figures[i] = 0.0
    room, volts = _room(n), np.zeros(n)
    margin, phase, before = 1e300, 0.0, 1.0 + 0.0j
    for f in range(lines):
        det, least = _add_line(
            controller[f], room, read_voltage[f], true_voltage[f], read_source[f], true_source[f], power[f], noise[f],
            omega[f], mode,
            tilting,
            volts,
            figures,
        )  # fmt: skip
        margin = min(margin, least)
        phase += _turn(det, before)
        before = det
    _finish(figures, volts, margin, phase)
