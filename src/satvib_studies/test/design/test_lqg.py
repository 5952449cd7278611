# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""LQG: its model, both Riccati equations, separation, the least cost, and the twin."""

import dataclasses
import math

import numpy as np
import pytest
from satvib_common.struts.motions import mode_matrix
from satvib_control.laws.state_space.matrices import response
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.responses.all_struts import rig_response, sampled_rig
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import load_rig
from satvib_studies.design.closed_loop import closed_loop_matrix, closed_loop_poles
from satvib_studies.design.lqg import design_lqg
from satvib_studies.design.model import DesignModel, Shaking, _source, design_model
from satvib_studies.tuning.cost import CostSettings, TuningCost
from satvib_studies.tuning.loop_cost import LoopFigure
from scipy.integrate import quad
from scipy.linalg import expm, solve_continuous_lyapunov, solve_discrete_lyapunov

SHAKING = Shaking(tone=0.3, damping=0.01, voltage_noise=0.05, sensor_noise=0.05)
WEIGHT = 0.3


@pytest.fixture(scope='module')
def rig():
    return load_rig('soft_3dof')


@pytest.fixture(scope='module')
def model(rig):
    return design_model(rig, SHAKING)


@pytest.fixture(scope='module')
def design(model):
    return design_lqg(model, WEIGHT)


def test_what_shakes_has_the_rms_that_is_given():
    """Truth: broad band and tone are independent, so their powers add; 1e-9."""
    A, G, c = _source(SHAKING)
    P = solve_continuous_lyapunov(A, -G @ G.T)
    assert c @ P @ c == pytest.approx(SHAKING.broad_band**2 + SHAKING.tone**2, rel=1e-9)


def test_the_model_shakes_as_the_rig_does(rig):
    """Truth: the rig's exact response to the source, integrated over frequency by SciPy's quad, without noise; 1e-4."""
    quiet = dataclasses.replace(SHAKING, voltage_noise=0.0)
    model = design_model(rig, quiet)
    found = np.diag(model.Z @ solve_discrete_lyapunov(model.A, model.Q) @ model.Z.T)
    A, G, c = _source(quiet)
    mode = mode_matrix(rig.struts.angles)

    def power(f):
        shape = c @ np.linalg.solve(2j * math.pi * f * np.eye(4) - A, G)
        to = mode @ rig_response(rig, [f]).true_source[0, :, 0]
        return 2.0 * float(np.sum(np.abs(shape) ** 2)) * float(np.abs(to[0]) ** 2)

    # white noise of intensity 1 has a density of 1 per Hz, on both sides of 0
    truth, _ = quad(power, 0.0, 2e3, points=[1.0, 8.6, 9.0, 9.4, 30.0], limit=800)
    assert found[0] == pytest.approx(truth, rel=1e-4)


def test_the_model_answers_as_the_sampled_rig(rig, model):
    """Truth: the rig's sampled response from every voltage to every reading; 1e-9."""
    f = np.array([0.5, 8.7, 40.0, 90.0])
    z = np.exp(2j * np.pi * f / rig.acquisition.sample_rate)[:, None, None]
    found = model.C @ np.linalg.solve(z * np.eye(len(model.A)) - model.A, model.B[None])
    truth = sampled_rig(rig).response(f)
    assert np.abs(found - truth).max() < 1e-9 * np.abs(truth).max()


def test_both_riccati_equations_are_solved(model, design):
    """Truth: the equations themselves, in the unit of their largest term; 1e-9."""
    A, B, C, X, P = model.A, model.B, model.C, design.X, design.P
    r = WEIGHT**2 * np.eye(3)
    inner = np.linalg.solve(r + B.T @ X @ B, B.T @ X @ A)
    left = A.T @ X @ A + model.Z.T @ model.Z - A.T @ X @ B @ inner - X
    assert np.abs(left).max() < 1e-9 * np.abs(X).max()
    inner = np.linalg.solve(model.R + C @ P @ C.T, C @ P @ A.T)
    left = A @ P @ A.T + model.Q - A @ P @ C.T @ inner - P
    assert np.abs(left).max() < 1e-9 * np.abs(P).max()
    for solution in (X, P):
        assert (
            np.linalg.eigvalsh(0.5 * (solution + solution.T)).min() > -1e-9 * np.abs(solution).max()
        )


def test_one_state_has_a_closed_form():
    """Truth: the root of the quadratic equation that the Riccati equation of one state is; 1e-12."""
    a, q, r, e = 0.9, 2.0, 0.5, 0.7
    one = DesignModel(*(np.array([[v]]) for v in (a, 1.0, 1.0, math.sqrt(q), 0.3, e)))
    found = design_lqg(one, math.sqrt(r))

    def root(q, r):
        half = 0.5 * (q - r * (1.0 - a * a))
        return half + math.sqrt(half * half + q * r)

    X, P = root(q, r), root(0.3, e)
    assert found.X[0, 0] == pytest.approx(X, rel=1e-12)
    assert found.P[0, 0] == pytest.approx(P, rel=1e-12)
    assert found.K[0, 0] == pytest.approx(a * X / (r + X), rel=1e-12)
    assert found.M[0, 0] == pytest.approx(P / (e + P), rel=1e-12)


def test_poles_of_the_loop_are_those_of_regulator_and_estimator(rig, model, design):
    """Separation. Truth: det(z - A + B K) det(z - A + A M C), at 20 points of a circle; 1e-8.

    The loop is put together from the rig's own sampled model, which has no states of the disturbance, and has the chain
    of the lower sensor besides.
    """
    matrices = design.matrices
    assert np.abs(closed_loop_poles(rig, matrices)).max() < 1.0
    loop = closed_loop_matrix(sampled_rig(rig), matrices)
    regulator = model.A - model.B @ design.K
    estimator = model.A - model.A @ design.M @ model.C
    assert max(np.abs(np.linalg.eigvals(m)).max() for m in (regulator, estimator)) < 1.0
    source = expm(_source(SHAKING)[0] * rig.acquisition.period)
    own = sampled_rig(rig).A
    n, stages = 3, 1 + rig.acquisition.filter_order
    lower = (len(own) - (n + 1) * stages) + n + (n + 1) * np.arange(stages)
    chain = own[np.ix_(lower, lower)]

    def det(z, matrix):
        return np.linalg.det(z * np.eye(len(matrix)) - matrix)

    for angle in np.linspace(0.0, np.pi, 20):
        z = 1.2 * np.exp(1j * angle)
        wanted = det(z, regulator) * det(z, estimator) * det(z, chain) / det(z, source)
        assert abs(det(z, loop) / wanted - 1.0) < 1e-8


def closed_cost(model, K, M, weight):
    """E[q'q + r u'u] of a regulator and an estimator on the model, by a Lyapunov equation of the whole loop."""
    A, B, C, s = model.A, model.B, model.C, len(model.A)
    through = np.eye(s) - M @ C
    # states x, x_p; u = -K (x_p + M (C x + e - C x_p))
    u_x, u_p, u_e = -K @ M @ C, -K @ through, -K @ M
    loop = np.block([[A + B @ u_x, B @ u_p], [A @ M @ C + B @ u_x, A @ through + B @ u_p]])
    noise = np.block([[np.eye(s), B @ u_e], [np.zeros((s, s)), A @ M + B @ u_e]])
    spread = np.block([[model.Q, np.zeros((s, 3))], [np.zeros((3, s)), model.R]])
    P = solve_discrete_lyapunov(loop, noise @ spread @ noise.T)
    both = np.hstack([u_x, u_p])
    q = model.Z @ P[:s, :s] @ model.Z.T
    u = both @ P @ both.T + u_e @ model.R @ u_e.T
    return float(np.trace(q) + weight**2 * np.trace(u))


def test_the_cost_is_the_least_one(model, design):
    """Truth: the formula tr(X Q) + tr(K'(r + B'XB) K P_f), P_f the error after a reading; other gains cost more."""
    X, P, K, M = design.X, design.P, design.K, design.M
    filtered = P - M @ model.C @ P
    r = WEIGHT**2 * np.eye(3)
    least = np.trace(X @ model.Q) + np.trace(K.T @ (r + model.B.T @ X @ model.B) @ K @ filtered)
    found = closed_cost(model, K, M, WEIGHT)
    assert found == pytest.approx(least, rel=1e-6)
    draw = np.random.default_rng(1)
    for _ in range(4):
        other = K * (1.0 + 0.05 * draw.normal(size=K.shape))
        assert closed_cost(model, other, M, WEIGHT) > found
        other = M * (1.0 + 0.05 * draw.normal(size=M.shape))
        assert closed_cost(model, K, other, WEIGHT) > found


def test_the_estimate_is_right_whatever_voltage_is_applied(model, design):
    """Truth: the model's own state under random voltages that the controller did not ask for; 1e-9 after 60 s."""
    m, draw = design.matrices, np.random.default_rng(2)
    x, estimate = draw.normal(size=len(model.A)), np.zeros(len(model.A))
    for _ in range(12_000):
        y, v = model.C @ x, draw.normal(size=3)
        estimate = m.A @ estimate + m.B @ y + m.E @ v
        x = model.A @ x + model.B @ v
    assert estimate == pytest.approx(x, abs=1e-9 * np.abs(x).max())


def test_the_twin_does_what_the_linear_loop_says(rig, design):
    """Truth: the loop by frequency, independent of time: RMS of the modes under a 9 Hz tone; 2 % of that of heave."""
    tone = {'kind': 'sine', 'frequency': 9.0, 'amplitude': 0.5}
    cost = TuningCost(rig, make_disturbance(tone), CostSettings(plants=1))
    omega = 2.0 * np.pi * cost.frequency * rig.acquisition.period
    figures = cost.controller_figures(-response(design.matrices, omega))[0]
    settings = [
        'name=check', 'scheme=centralized', 'duration=9', 'seed=2', 'controller={}', 'analysis={}',
        'phases=[{phase: CALIBRATE}, {phase: CONTROL, start: 1}]',
        'disturbance={kind: sine, frequency: 9.0, amplitude: 0.5, start: 1.0}',
    ]  # fmt: skip
    scenario = load_scenario('soft_3dof', settings)
    scenario = scenario.replace(centralized={'law': 'state_space', **design.matrices.parameters()})
    run = simulate(scenario)
    truth = run.get('truth', 'upper')[run.window(7.0, 9.0)]
    modes = np.einsum('mi,kif->mkf', mode_matrix(rig.struts.angles), truth)
    found = np.sqrt(np.mean(modes**2, axis=(1, 2)))
    heave = figures[LoopFigure.MODES]
    assert found == pytest.approx(figures[LoopFigure.MODES :], abs=0.02 * heave)
    assert heave < 0.3 * cost.quiet[LoopFigure.MODES]


SIDEWAYS = (0.8, 0.0, 0.6, 0.0, 0.0, 0.0, *(0.0,) * 6)
TURNING = (0.0, 0.5, 0.0, 4.0, 0.0, 0.0, *(0.0,) * 6)


@pytest.fixture(scope='module')
def six():
    return load_rig('hexapod_6dof')


def test_six_struts_shake_as_the_rig_does(six):
    """Truth: the rig's exact response to a base that moves in one direction, summed over 0.02 to 2000 Hz; 1e-3."""
    quiet = Shaking(frequency=7.0, damping=0.01, voltage_noise=0.0, directions=(SIDEWAYS,))
    model = design_model(six, quiet)
    found = np.diag(model.Z @ solve_discrete_lyapunov(model.A, model.Q) @ model.Z.T)
    A, G, c = _source(quiet)
    f = np.geomspace(0.02, 2e3, 12_000)
    shape = c @ np.linalg.solve(2j * math.pi * f[:, None, None] * np.eye(4) - A, G)
    source = rig_response(six, f).true_source @ np.array(SIDEWAYS)
    to = source @ payload_modes(six).mode.T
    density = 2.0 * np.sum(np.abs(shape) ** 2, axis=1)[:, None] * np.abs(to) ** 2
    truth = np.trapezoid(density, f, axis=0)
    assert np.sum(found) == pytest.approx(np.sum(truth), rel=1e-3)


def test_six_struts_shaken_in_two_directions_have_a_stable_design(six):
    """Truth: the rig's sampled response, 1e-9; no negative variance, to rounding; poles of the whole loop inside 1.

    The covariance of a period was once that of all times less what is left of it: the design had no solution.
    """
    shaking = Shaking(
        frequency=7.0, tone=0.2, damping=0.01, voltage_noise=0.05, sensor_noise=0.05,
        directions=(SIDEWAYS, TURNING),
    )  # fmt: skip
    model = design_model(six, shaking)
    f = np.array([0.5, 6.9, 40.0, 90.0])
    z = np.exp(2j * np.pi * f / six.acquisition.sample_rate)[:, None, None]
    found = model.C @ np.linalg.solve(z * np.eye(len(model.A)) - model.A, model.B[None])
    truth = sampled_rig(six).response(f)
    assert np.abs(found - truth).max() < 1e-9 * np.abs(truth).max()
    powers = np.linalg.eigvalsh(model.Q)
    assert powers.min() > -1e-13 * powers.max()
    matrices = design_lqg(model, WEIGHT).matrices
    assert np.abs(closed_loop_poles(six, matrices)).max() < 1.0
