# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Exact transmissibility, open and closed loop."""

import numpy as np
from numpy.testing import assert_allclose
from satvib_common.signals.integrator import LeakyIntegrator
from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.responses.transmission import transmissibility
from satvib_plant_sim.rig.any_rig import without_noise
from satvib_plant_sim.rig.rig import load_rig


def test_one_strut_is_the_text_books_formula():
    """Truth: (j w c + k) / (k - m w^2 + j w c) of a mass on a spring and a damper, coil open; 1e-9."""
    rig = load_rig('clean_1dof', {'coil.force_constant': 0.0})
    f = np.geomspace(0.5, 400.0, 50)
    s = 2j * np.pi * f
    k, c, m = rig.struts.stiffness, rig.struts.damping, rig.payload.mass
    k *= rig.struts.stiffness_scale[0]
    c *= rig.struts.damping_scale[0]
    expected = (c * s + k) / (m * s * s + c * s + k)
    assert_allclose(transmissibility(rig, f)[:, 0], expected, rtol=1e-9)


def test_no_feedback_is_the_open_loop():
    """Truth: the open loop; 1e-12."""
    rig = load_rig('soft_3dof')
    f = np.array([2.0, 9.0, 40.0])
    zero = np.zeros((3, 3, 3), dtype=complex)
    assert_allclose(transmissibility(rig, f, zero), transmissibility(rig, f), rtol=1e-12)


def test_closed_loop_is_what_the_plant_does():
    """Truth: the simulated plant under velocity feedback, a tone fitted to its true accelerations in the steady state.

    0.2 %: the voltage of a sampled loop has images, which the baseband leaves out.
    """
    rig = without_noise(
        load_rig('soft_3dof', {'acquisition.output_bits': 0, 'acquisition.input_bits': 0})
    )
    dt, gain = rig.acquisition.period, 60.0
    law = LeakyIntegrator(0.5, dt, (3,))
    b, a = law.b, law.a
    for f in (5.0, 9.0, 25.0):
        tone = make_disturbance({'kind': 'sine', 'frequency': f, 'amplitude': 0.05})
        plant = Plant(rig, tone, 1)
        bias = plant.sample()
        law.reset()
        upper, lower = [], []
        for k in range(2400):
            y = plant.sample().upper - bias.upper
            truth = plant.advance(-gain * law.velocity(y))
            if k >= 2000:
                upper.append(truth.upper.T)
                lower.append(truth.lower.T)
        x, y = (np.concatenate(part) for part in (lower, upper))
        t = np.arange(len(x)) * plant.fine_period
        turn = np.exp(-2j * np.pi * f * t)[:, None]
        z = np.exp(2j * np.pi * f * dt)
        h = np.polyval(b, z) / np.polyval(a, z)
        feedback = (gain * h * np.eye(3))[None]
        found = np.sum(y * turn, axis=0) / np.sum(x * turn, axis=0)
        assert_allclose(found, transmissibility(rig, [f], feedback)[0], rtol=2e-3)
