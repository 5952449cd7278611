# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The responses that tuning rests on, against the simulated plant and against the model of a single strut."""

import numpy as np
import pytest
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.responses.all_struts import rig_response, sampled_rig
from satvib_plant_sim.responses.continuous import source_transfer
from satvib_plant_sim.responses.one_strut import discrete_strut_model
from satvib_plant_sim.rig.any_rig import without_noise
from satvib_plant_sim.rig.rig import load_rig

RIGS = ('paper_3dof', 'clean_3dof', 'soft_3dof', 'paper_1dof')


def quiet(name, **changes):
    """A rig without noise, bias and quantization."""
    rig = without_noise(load_rig(name, {'accelerometer.zero_tolerance': 0.0, **changes}))
    return rig.replace(acquisition=rig.acquisition.replace(output_bits=0))


@pytest.mark.parametrize('name', RIGS)
def test_the_diagonal_is_the_model_of_a_single_strut(name):
    """Truth: `discrete_strut_model`, which is tested against the plant; the same numbers to 1e-9 of the largest."""
    rig = load_rig(name)
    f = np.linspace(0.5, 0.49 * rig.acquisition.sample_rate, 40)
    whole = sampled_rig(rig).response(f)
    for i in range(rig.struts.count):
        single = discrete_strut_model(rig, i).response(f)
        assert whole[:, i, i] == pytest.approx(single, abs=1e-9 * np.abs(single).max())


@pytest.mark.parametrize('name', RIGS)
def test_the_sampled_rig_is_the_plant(name):
    """Truth: the plant's own readings under random voltages at all struts; 1e-6 of the largest."""
    rig = quiet(name)
    n = rig.struts.count
    plant = Plant(rig, make_disturbance(None), 1)
    model = sampled_rig(rig)
    u = np.random.default_rng(5).uniform(-1.0, 1.0, (150, n))
    past = np.concatenate([np.zeros((model.late + len(model.B) - 1, n)), u])
    x, read, wanted = np.zeros(len(model.A)), [], []
    for k in range(len(u)):
        read.append(plant.sample().upper)
        wanted.append(model.C @ x)
        now = k + len(model.B) - 1
        x = model.A @ x + sum(B @ past[now - i] for i, B in enumerate(model.B))
        plant.advance(u[k])
    wanted = np.array(wanted)
    assert np.array(read) == pytest.approx(wanted, abs=1e-6 * np.abs(wanted).max())


@pytest.mark.parametrize('name', RIGS)
def test_a_tone_of_the_source_reaches_payload_and_reading_as_said(name):
    """Truth: the plant's fine truth under a 10 Hz tone after 8 s, fitted by least squares; 1 %."""
    rig = quiet(name)
    plant = Plant(rig, make_disturbance({'kind': 'sine', 'frequency': 10.0, 'amplitude': 0.5}), 1)
    rate = rig.acquisition.sample_rate
    zero = np.zeros(rig.struts.count)
    reads, truths = [], []
    for _ in range(round(10.0 * rate)):
        reads.append(plant.sample().upper)
        truths.append(plant.advance(zero).upper.T)
    source = 0.5 / source_transfer(rig, 10.0)
    r = rig_response(rig, [10.0])
    for series, response in (
        (np.array(reads)[round(8.0 * rate) :], r.read_source),
        (np.concatenate(truths[round(8.0 * rate) :]), r.true_source),
    ):
        t = 2.0 * np.pi * 10.0 * 2.0 * np.arange(len(series)) / len(series)
        basis = np.column_stack([np.cos(t), np.sin(t)])
        weights = np.linalg.lstsq(basis, series, rcond=None)[0]
        found = np.hypot(*weights)
        assert found == pytest.approx(source * np.abs(response[0, :, 0]), rel=0.01)
