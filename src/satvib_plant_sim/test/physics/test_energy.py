# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Energy: nothing in the plant may create it."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.rig import load_rig

NONE = make_disturbance(None)
LOSSLESS = {
    'struts.damping': 0.0,
    'struts.stop_damping': 0.0,
    'shaker.damping': 0.0,
    'coil.force_constant': 0.0,
}


def energies(plant, samples):
    """Energy at every sample, and whether a stop was ever touched."""
    found, touched = [float(plant.energy())], False
    for _ in range(samples):
        truth = plant.advance(np.zeros(plant.struts))
        touched |= bool(np.any(truth.stroke_peak > plant.rigs[0].struts.stroke_limit))
        found.append(float(plant.energy()))
    return np.array(found), touched


@pytest.mark.parametrize('name', ['paper_3dof', 'paper_1dof', 'soft_3dof'])
def test_energy_never_grows_without_input(name):
    """Truth: the second law; growth at most 1e-13 of the first energy (rounding).

    At most exp(-2 zeta wn t) = 0.6 % is left by the slowest mode of the soft rig after 1 s.
    """
    plant = Plant(load_rig(name), NONE, 1)
    plant.displace(np.linspace(3e-3, 5e-3, plant.struts))
    found, touched = energies(plant, 200)
    assert not touched
    assert np.all(np.diff(found) <= 1e-13 * found[0])
    assert found[-1] < 0.01 * found[0]


@settings(max_examples=25, deadline=None)
@given(
    strokes=st.tuples(*[st.floats(-0.03, 0.03)] * 3),
    stiffness=st.floats(1e4, 1e8),
    damping=st.floats(0.0, 1e4),
)
def test_stops_never_create_energy(strokes, stiffness, damping):
    """Truth: the second law, soft and hard stops, from deep inside; growth at most 1e-11 of the first energy.

    Strokes below 1e-100 m are left out: their energy is a subnormal number, which has no relative precision.
    """
    assume(max(map(abs, strokes)) > 1e-100)
    changes = {'struts.stop_stiffness': stiffness, 'struts.stop_damping': damping}
    plant = Plant(load_rig('soft_3dof', changes), NONE, 1)
    plant.displace(np.array(strokes))
    found, _ = energies(plant, 40)
    assert np.all(np.diff(found) <= 1e-11 * found[0])


def test_without_losses_energy_stays_through_many_contacts():
    """Truth: conservation; 1e-9 of the first energy over 400 samples and contacts on both sides."""
    rig = load_rig('soft_3dof', LOSSLESS)
    plant = Plant(rig, NONE, 1)
    plant.displace(np.array([9.5e-3, 9e-3, 8e-3]))
    found, touched = energies(plant, 400)
    assert touched
    assert_allclose(found, found[0], rtol=1e-9)


def test_a_stop_holds_the_payload():
    """Truth: the linear rig at resonance goes far beyond the stop; the stop gives way by F / k, below 1 mm."""
    shake = make_disturbance({'kind': 'sine', 'amplitude': 4.0, 'frequency': 9.0})
    peaks = {}
    for limit in (7.6e-3, 1.0):
        plant = Plant(load_rig('soft_3dof', {'struts.stroke_limit': limit}), shake, 1)
        peaks[limit] = max(plant.advance(np.zeros(3)).stroke_peak.max() for _ in range(600))
    assert peaks[1.0] > 10e-3
    assert 7.6e-3 < peaks[7.6e-3] < 8.6e-3


def test_the_coil_stops_at_its_peak_force():
    """Truth: 71.2 N, with a winding that would let 20 V drive 147 N; held current over a step: 1e-9."""
    rig = load_rig('paper_3dof', {'coil.resistance': 1.333})
    plant = Plant(rig, NONE, 1)
    force = current = 0.0
    for _ in range(30):
        truth = plant.advance(np.full(3, 20.0))
        force, current = max(force, truth.force_peak.max()), truth.current.max()
    assert current > 14.0
    assert force == pytest.approx(71.2, rel=1e-9)
    # the plant moves by what the limited force can hold: K s = 71.2 N
    assert_allclose(truth.stroke * 49500.0 * np.array([0.97, 1.0, 1.03]), 71.2, rtol=0.03)


def test_energy_never_grows_while_the_coil_is_saturated():
    """Truth: the second law, with a force limit of 1 mN that the damping currents exceed at once; 1e-9 of the start."""
    plant = Plant(load_rig('paper_3dof', {'coil.force_limit': 1e-3}), NONE, 1)
    plant.displace(5e-3)
    found, _ = energies(plant, 60)
    assert np.all(np.diff(found) <= 1e-9 * found[0])
