# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Rigs that are identified models."""

import numpy as np
import pytest
import yaml
from numpy.testing import assert_allclose, assert_array_equal
from satvib_common.errors import SatvibError
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.plant.any_plant import make_plant
from satvib_plant_sim.plant.identified_plant import IirPlant
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.responses.one_strut import strut_response
from satvib_plant_sim.rig.any_rig import load_any_rig
from satvib_plant_sim.rig.identified_rig import IirRig
from satvib_plant_sim.rig.rig import load_rig
from scipy.signal import lfilter

NONE = make_disturbance(None)
# the G(z) that the paper prints
A, B = [-0.460, 0.158], [0.061, -0.103, 0.033]


def rig(**changes):
    """A rig of two struts, the paper's model and one with more delay."""
    models = [{'a': A, 'b': B}, {'a': [-0.5], 'b': [1.0], 'delay': 3, 'primary_b': [0.0, 2.0]}]
    data = {'acquisition': {'sample_rate': 100.0}, 'models': models, **changes}
    return IirRig.from_mapping(data)


def test_the_output_is_the_filtered_input():
    """Truth: scipy's lfilter, delayed; 1e-13. The lower plate is not measured."""
    plant = IirPlant(rig(), NONE, 1)
    u = np.random.default_rng(0).uniform(-5.0, 5.0, (80, 2))
    y = []
    for v in u:
        sample = plant.sample()
        assert np.isnan(sample.lower).all()
        truth = plant.advance(v)
        assert_array_equal(truth.upper[:, 0], sample.upper)
        y.append(sample.upper)
    expected = np.stack(
        [
            lfilter([0.0, *B], [1.0, *A], u[:, 0]),
            lfilter([0.0, 0.0, 0.0, 1.0], [1.0, -0.5], u[:, 1]),
        ],
        axis=1,
    )
    assert_allclose(np.array(y), expected, atol=1e-13)


def test_a_disturbance_takes_the_primary_path_and_voltages_are_limited():
    """Truth: a sine, and twice the same one sample later; a constant 100 V that acts as 2 V; 1e-12."""
    tone = make_disturbance({'kind': 'sine', 'amplitude': 1.0, 'frequency': 7.0})
    plant = IirPlant(rig(voltage_limit=2.0), tone, 1)
    y = []
    for _ in range(300):
        y.append(plant.sample().upper)
        plant.advance([100.0, 0.0])
    assert_array_equal(plant.terminal_voltage, [2.0, 0.0])
    t = np.arange(300) / 100.0
    d = np.sin(2 * np.pi * 7.0 * t)
    gain = 2.0 * sum(B) / (1.0 + sum(A))
    y = np.array(y)
    assert_allclose(y[100:, 0] - d[100:], gain, atol=1e-12)
    assert_allclose(y[1:, 1], 2.0 * d[:-1], atol=1e-12)


def test_noise_bias_and_steps_of_a_reading():
    """Truth: RMS and bias asked for, 5 standard errors of 4000 numbers; readings on the grid, 1e-9."""
    noisy = rig(noise_rms=0.3, bias=0.5)
    plant, coarse = IirPlant(noisy, NONE, 4), IirPlant(noisy.replace(quantum=0.1), NONE, 4)
    fine, steps = [], []
    for _ in range(2000):
        fine.append(plant.sample().upper)
        steps.append(coarse.sample().upper)
        plant.advance([0.0, 0.0])
        coarse.advance([0.0, 0.0])
    fine, steps = np.array(fine), np.array(steps)
    assert_allclose(np.std(fine), 0.3, rtol=5 / np.sqrt(8000))
    assert_allclose(np.mean(fine), 0.5, atol=5 * 0.3 / np.sqrt(4000))
    assert np.abs(steps - fine).max() <= 0.05 * (1 + 1e-9)
    assert_allclose(steps / 0.1, np.rint(steps / 0.1), atol=1e-9)
    assert noisy.replace(quantum=0.1).noise_floor() == pytest.approx(np.hypot(0.3, 0.1 / 12**0.5))


def test_a_batch_equals_its_trials():
    """Truth: single plants; bit for bit, with models of different lengths."""
    noise = make_disturbance({'kind': 'random', 'rms': 1.0, 'high': 20.0})
    longer = rig(models=[{'a': [*A, 0.01], 'b': B}, {'a': [], 'b': [0.5]}], noise_rms=0.1)
    rigs, seeds = [rig(noise_rms=0.1), longer], [5, 6]
    u = np.random.default_rng(0).uniform(-5.0, 5.0, (50, 2, 2))
    together = IirPlant(rigs, noise, seeds)
    alone = [IirPlant(r, noise, s) for r, s in zip(rigs, seeds, strict=True)]
    for v in u:
        whole = together.sample()
        truth = together.advance(v)
        for i, single in enumerate(alone):
            assert_array_equal(single.sample().upper, whole.upper[i])
            assert_array_equal(single.advance(v[i]).upper, truth.upper[i])


def test_a_rig_file_takes_in_the_files_of_its_models(tmp_path):
    """Truth: what the model file says; the format is that of `satvib identify --save`."""
    model = {'delay': 2, 'sample_period': 0.01, 'a': A, 'b': B}
    saved = {'format': 'satvib-model-1', 'model': model, 'about': {}}
    (tmp_path / 'strut.yaml').write_text(yaml.safe_dump(saved))
    data = {'plant': 'iir', 'acquisition': {'sample_rate': 100.0}}
    data['models'] = [{'file': 'strut.yaml', 'primary_b': [2.0]}, {'a': A, 'b': B}]
    path = tmp_path / 'rig.yaml'
    path.write_text(yaml.safe_dump(data))
    loaded = load_any_rig(path, {'noise_rms': 0.2, 'models.1.delay': 4})
    assert isinstance(loaded, IirRig)
    assert (loaded.name, loaded.noise_rms) == ('rig', 0.2)
    assert loaded.models[0].delay == 2
    assert loaded.models[0].a == tuple(A)
    assert loaded.models[0].primary_b == (2.0,)
    assert loaded.models[1].delay == 4
    assert IirRig.from_mapping(loaded.to_mapping()) == loaded
    assert isinstance(make_plant(loaded, NONE, 1), IirPlant)

    for change, message in (
        ({'acquisition': {'sample_rate': 200.0}}, 'is sampled at 100 Hz, the rig at 200 Hz'),
        ({'models': [{'file': 'none.yaml'}]}, 'none.yaml: cannot be read'),
        ({'models': [{'file': 'rig.yaml'}]}, 'is not a model file'),
        ({'models': [{'a': [-1.2], 'b': [1.0]}]}, r'models\[0\].a: unstable, a pole of'),
        ({'models': []}, 'models: empty'),
        ({'models': [{'a': A, 'b': B, 'delay': 0}]}, r'delay: 0 is less than 1 samples'),
        ({'noise': 1.0}, 'noise: no such key; did you mean noise_rms'),
    ):
        path.write_text(yaml.safe_dump({**data, **change}))
        with pytest.raises(SatvibError, match=message):
            load_any_rig(path)


def test_mechanical_rigs_load_as_before():
    """Truth: `load_rig`."""
    loaded = load_any_rig('paper_1dof', {'payload.mass': 4.0})
    assert loaded == load_rig('paper_1dof', {'payload.mass': 4.0})
    assert isinstance(make_plant(loaded, NONE, 1), Plant)


def test_response_of_an_identified_rig_is_what_its_plant_does():
    """Truth: the plant itself, driven by a sine in steady state; 1e-9 of the amplitude."""
    rig = IirRig.from_mapping(
        {
            'acquisition': {'sample_rate': 100.0},
            'models': [{'delay': 2, 'a': [-0.46, 0.158], 'b': [0.061, -0.103, 0.033]}],
        }
    )
    f = 12.5
    k = np.arange(400)
    u = np.exp(2j * np.pi * f * k / 100.0)
    parts = []
    for part in (u.real, u.imag):
        plant = make_plant(rig, NONE, 1)
        readings = []
        for value in part:
            readings.append(float(plant.sample().upper[0]))
            plant.advance(np.array([value]))
        parts.append(np.array(readings))
    y = parts[0] + 1j * parts[1]
    response = strut_response(rig, 0, np.array([f]))[0]
    np.testing.assert_allclose(y[200:] / u[200:], response, atol=1e-9)
