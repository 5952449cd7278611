# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The payload on its struts: stiffness, modes, and the free response of each strut.

K_0 = J^T diag(K_i) J,   det(K_0 - (2 pi f)^2 M) = 0   (lower plate held)
"""

import math

import numpy as np
from satvib_common.arrays import Array

from satvib_plant_sim.physics.mechanics import mechanics
from satvib_plant_sim.physics.state import size_of, state_of, state_size
from satvib_plant_sim.rig.rig import Rig


def static_stiffness(rig: Rig) -> Array:
    """Give K_0 (dof, dof) in the payload's motions: N/m, N, N m; the lower plate is held."""
    m = mechanics(rig)
    K: Array = (m.S.T * m.K) @ m.S
    return K


def modal_frequencies(rig: Rig) -> Array:
    """Give the payload's undamped modes (dof,), Hz, ascending; the lower plate is held and the coils are open."""
    m = mechanics(rig)
    root = np.linalg.inv(np.linalg.cholesky(m.M))
    values = np.linalg.eigvalsh(root @ static_stiffness(rig) @ root.T)
    return np.sqrt(values) / (2.0 * math.pi)


def equilibrium(rig: Rig, stroke: Array) -> Array:
    """Give the state at rest with strokes (n), m: the lower plate gives way to the struts.

    Struts that are more than the payload has motions get the strokes nearest to these that it can have.
    """
    size, m = size_of(rig), mechanics(rig)
    x = np.zeros(state_size(size))
    state = state_of(x, size)
    if size.struts > m.S.shape[1]:
        stroke = m.S @ np.linalg.lstsq(m.S, stroke)[0]
    state.stroke[:] = stroke
    if not rig.shaker.rigid:
        force = np.sum(m.P * (m.K * stroke)[:, None], axis=0)
        plate = rig.shaker.suspension
        state.plate[:] = force / (plate.stiffness * (m.m_l / plate.mass))
    return x


def free_response(rig: Rig, duration: float = 0.15, heave: float = 1e-3) -> tuple[Array, Array]:
    """Give the free response from a heave, all coils at 0 V.

    Args:
        rig: without its stops and limits.
        duration: s.
        heave: m, stroke of every strut at the beginning.

    Returns:
        Times (t,), s, every 0.25 ms, and the motions w_i (n, t), m, of the heads along the struts, relative to the
        source.
    """
    from scipy.linalg import expm  # a plant that runs needs no SciPy

    size, m = size_of(rig), mechanics(rig)
    h = 0.25e-3
    E = expm(m.A * h)
    x = equilibrium(rig, np.full(size.struts, heave))
    times = np.arange(round(duration / h), dtype=np.float64) * h
    motion = np.empty((size.struts, len(times)))
    for j in range(len(times)):
        state = state_of(x, size)
        motion[:, j] = state.stroke + m.P @ state.plate
        x = E @ x
    return times, motion


def strut_modes(rig: Rig, duration: float = 0.15) -> tuple[Array, Array]:
    """Fit w_i'' + 2 zeta wn w_i' + wn^2 w_i = 0, started at rest, to each strut's own free response.

    Returns:
        wn (n,), rad/s, and zeta (n,).
    """
    from scipy.optimize import least_squares

    times, motion = free_response(rig, duration)
    start = 2.0 * math.pi * float(np.mean(modal_frequencies(rig)))
    found = []
    for w in motion:
        target = w / w[0]

        def misfit(p: Array, target: Array = target) -> Array:
            root = np.sqrt(complex(p[1] * p[1] - 1.0))
            s1, s2 = p[0] * (-p[1] + root), p[0] * (-p[1] - root)
            model = (s1 * np.exp(s2 * times) - s2 * np.exp(s1 * times)) / (s1 - s2)
            return np.asarray(model.real - target)

        found.append(least_squares(misfit, [start, 0.5], x_scale=[start, 1.0], xtol=1e-12).x)
    fitted: Array = np.array(found)
    wn, zeta = fitted.T
    return wn, zeta
