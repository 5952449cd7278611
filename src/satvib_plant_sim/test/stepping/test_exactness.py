# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The kernel against an adaptive integrator."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.responses.continuous import state_space
from satvib_plant_sim.rig.rig import load_rig
from scipy.integrate import solve_ivp

QUIET = {
    'accelerometer.noise_rms': 0.0,
    'accelerometer.zero_tolerance': 0.0,
    'acquisition.input_bits': 0,
    'acquisition.output_bits': 0,
}
CORNERS, HEIGHTS = [0.0, 0.01, 0.03, 0.06], [0.0, 1.0, 1.0, 0.0]


def reference(rig, times, corners, disturbance, voltage_at):
    """Outputs of the rig's state space at `times`, integrated from one corner of its inputs to the next."""
    system = state_space(rig)
    x = np.zeros(len(system.A))
    found = np.zeros((len(times), len(system.outputs)))
    for begin, end in pairwise(corners):
        if end - begin < 1e-9:
            continue
        # inputs are straight lines between corners: two points inside define them
        t1, t2 = begin + 0.25 * (end - begin), begin + 0.75 * (end - begin)
        u1 = np.array([*voltage_at(t1), disturbance(t1), 0.0])
        u2 = np.array([*voltage_at(t2), disturbance(t2), 0.0])
        slope = (u2 - u1) / (t2 - t1)

        def u(t, u1=u1, t1=t1, slope=slope):
            return u1 + slope * (t - t1)

        inside = np.flatnonzero((times > begin - 1e-10) & (times < end - 1e-10))
        wanted = np.unique(np.clip([*times[inside], end], begin, end))
        solution = solve_ivp(
            lambda t, x, u=u: system.A @ x + system.B @ u(t),
            (begin, end),
            x,
            method='DOP853',
            rtol=1e-12,
            atol=1e-14,
            t_eval=wanted,
        )
        for i in inside:
            at = np.argmin(np.abs(solution.t - times[i]))
            found[i] = system.C @ solution.y[:, at] + system.D @ u(times[i])
        x = solution.y[:, -1]
    return found


CASES = {
    'zero hold, delay on the grid': ('paper_3dof', {}),
    'zero hold, delay between': ('paper_3dof', {'acquisition.input_delay': 0.00137}),
    'linear hold, no delay': (
        'paper_3dof',
        {'acquisition.hold': 'linear', 'acquisition.input_delay': 0.0},
    ),
    'linear hold, delay over two periods': (
        'paper_3dof',
        {'acquisition.hold': 'linear', 'acquisition.input_delay': 0.02337},
    ),
    'fourth-order filter': ('clean_3dof', {'acquisition.input_delay': 0.00137}),
    'current drive, delay over a period': ('soft_3dof', {'acquisition.input_delay': 0.00611}),
    'rigid shaker': ('soft_3dof', {'shaker.rigid': True}),
    'one strut, third-order filter': ('paper_1dof', {'acquisition.filter_order': 3}),
    'no filter, 1 kHz': (
        'clean_1dof',
        {'acquisition.filter_order': 0, 'acquisition.sample_rate': 1000.0},
    ),
}


@pytest.mark.parametrize('case', CASES)
def test_truth_and_readings_equal_the_integrator(case):
    """Truth: scipy's DOP853 at rtol 1e-12 on the continuous equations; 1e-9 of the peak, readings and fine points."""
    name, changes = CASES[case]
    rig = load_rig(name, {**QUIET, **changes})
    shape = {'kind': 'trapezoid', 'amplitude': 1.0, 'rise': 0.01, 'hold': 0.02, 'fall': 0.03}
    plant = Plant(rig, make_disturbance(shape), 1)
    n, T, delay = plant.struts, plant.dt, rig.acquisition.input_delay
    samples = 14
    volts = np.random.default_rng(3).uniform(-5.0, 5.0, (samples, n))
    readings, upper, lower = [], [], []
    for k in range(samples):
        sample = plant.sample()
        readings.append([*sample.upper, sample.lower[0]])
        truth = plant.advance(volts[k])
        upper.append(truth.upper)
        lower.append(truth.lower[0])

    def voltage_at(t):
        k = int(np.floor((t - delay) / T))
        if k < 0:
            return np.zeros(n)
        if rig.acquisition.hold == 'zero':
            return volts[k]
        before = volts[k - 1] if k > 0 else np.zeros(n)
        return before + (volts[k] - before) * ((t - delay) / T - k)

    times = np.arange(samples * plant.n_fine) * plant.fine_period
    arrivals = np.arange(samples) * T + delay
    corners = sorted(
        {round(t, 12) for t in [0.0, *CORNERS, *np.arange(samples + 1) * T, *arrivals]}
    )
    corners = [t for t in corners if t <= samples * T + 1e-12]
    expected = reference(rig, times, corners, lambda t: np.interp(t, CORNERS, HEIGHTS), voltage_at)
    close = 1e-9 * np.abs(expected).max()
    assert_allclose(np.concatenate(upper, axis=1).T, expected[:, :n], atol=close)
    assert_allclose(np.concatenate(lower), expected[:, n], atol=close)
    assert_allclose(np.array(readings), expected[:: plant.n_fine, n + 1 :], atol=close)
