# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Six struts: geometry, mass and stiffness, modes, reciprocity, energy, and the steps of the plant."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.physics.mechanics import mechanics
from satvib_plant_sim.physics.modes import equilibrium, modal_frequencies, static_stiffness
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.responses.all_struts import rig_response
from satvib_plant_sim.responses.continuous import frequency_response, state_space
from satvib_plant_sim.rig.rig import Rig, load_rig
from scipy.linalg import eigh, expm
from scipy.signal import lsim

NAME = 'hexapod_6dof'
ALIKE = {'struts.stiffness_scale': [1.0] * 6}
QUIET = {
    'accelerometer.noise_rms': 0.0,
    'accelerometer.zero_tolerance': 0.0,
    'acquisition.input_bits': 0,
    'acquisition.output_bits': 0,
}
CROOKED = {
    'payload.center_of_gravity': [0.012, -0.02, 0.035],
    'payload.inertia_tensor': [0.32, 0.36, 0.60, 0.03, -0.02, 0.04],
    'struts.stiffness_scale': [0.8, 1.1, 1.3, 0.9, 1.0, 1.2],
}
SOFT_PLATE = {'shaker.rigid': False, 'shaker.mass': 6.0, 'shaker.stiffness': 4e5}
SOFT_PLATE |= {'shaker.damping': 150.0, 'shaker.inertia': 0.2}
NONE = make_disturbance(None)


def independent(rig):
    """M and K in (x, y, z, rx, ry, rz) about the centre of gravity, from the struts' lengths by the complex step.

    The length of a strut whose head has moved is |head + t + theta x (head - c) - foot|; its derivative comes from a
    step of 1e-30 i, so it has no error of differences. Nothing of the project is used.
    """
    c = np.array(rig.payload.center_of_gravity)
    K = np.zeros((6, 6))
    for strut, scale in zip(rig.struts.each, rig.struts.stiffness_scale, strict=True):
        head, foot = np.array(strut.head), np.array(strut.foot)
        row = np.empty(6)
        for axis in range(6):
            q = np.zeros(6, dtype=complex)
            q[axis] = 1e-30j
            t, theta = q[:3], q[3:]
            arm = head - c
            turned = np.array(
                [
                    theta[1] * arm[2] - theta[2] * arm[1],
                    theta[2] * arm[0] - theta[0] * arm[2],
                    theta[0] * arm[1] - theta[1] * arm[0],
                ]
            )
            moved = head + t + turned - foot
            row[axis] = np.sqrt(np.sum(moved * moved)).imag / 1e-30
        K += rig.struts.stiffness * scale * np.outer(row, row)
    xx, yy, zz, xy, xz, yz = (*rig.payload.inertia_tensor, 0.0, 0.0, 0.0)[:6]
    M = np.zeros((6, 6))
    M[:3, :3] = rig.payload.mass * np.eye(3)
    M[3:, 3:] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return M, K


def test_a_cubic_platform_is_decoupled_in_closed_form():
    """Truth: Geng and Haynes 1994: K = k diag(2, 2, 2, L^2 / 2, L^2 / 2, 2 L^2), L the edge; neighbours are orthogonal.

    1e-9: the places are written with 12 digits.
    """
    rig = load_rig(NAME, ALIKE)
    k, edge = rig.struts.stiffness, 0.25
    expected = k * np.diag([2.0, 2.0, 2.0, edge**2 / 2, edge**2 / 2, 2 * edge**2])
    assert_allclose(static_stiffness(rig), expected, rtol=1e-9, atol=1e-9 * k)
    directions = mechanics(rig).S[:, :3]
    assert_allclose(np.sum(directions**2, axis=1), 1.0, rtol=1e-15)
    for i in range(6):
        assert abs(directions[i] @ directions[(i + 1) % 6]) < 1e-11
    inertia = np.array(rig.payload.inertia_tensor)
    squares = np.concatenate([[2 / 18.0] * 3, np.array([0.5, 0.5, 2.0]) * edge**2 / inertia])
    closed = np.sort(np.sqrt(k * squares)) / (2 * np.pi)
    assert_allclose(modal_frequencies(rig), closed, rtol=1e-9)


@pytest.mark.parametrize('changes', [{}, ALIKE, CROOKED], ids=['as it is', 'alike', 'crooked'])
def test_six_modes_equal_an_independent_computation(changes):
    """Truth: scipy's generalized eigenproblem on M and K from the struts' lengths; 1e-9 relative."""
    rig = load_rig(NAME, changes)
    M, K = independent(rig)
    assert_allclose(static_stiffness(rig), K, rtol=1e-9, atol=1e-9 * K.max())
    assert_allclose(mechanics(rig).M, M, rtol=0.0)
    frequencies = np.sqrt(eigh(K, M)[0]) / (2 * np.pi)
    assert len(frequencies) == 6
    assert_allclose(modal_frequencies(rig), frequencies, rtol=1e-9)


@pytest.mark.parametrize(
    'changes', [CROOKED, {**CROOKED, **SOFT_PLATE}], ids=['rigid', 'soft plate']
)
def test_what_one_strut_does_to_another_it_gets_back(changes):
    """Truth: Maxwell's reciprocity: from the force of a pair of plates to the acceleration between them; 1e-10."""
    rig = load_rig(NAME, changes)
    found = frequency_response(rig, np.array([2.0, 6.5, 9.0, 40.0]))
    response = found[:, :6, :6] - found[:, 6:12, :6]
    size = np.abs(response).max()
    assert_allclose(response, response.transpose(0, 2, 1), rtol=0.0, atol=1e-10 * size)
    assert np.abs(response[:, 0, 1]).max() > 1e-3 * size


def test_a_slow_base_carries_the_payload_with_it():
    """Truth: a rigid body: far below the modes the payload does what the base does, in all six directions.

    The difference is (f / f_n)^2 = 3e-6 at 0.01 Hz; 1e-5 of the largest.
    """
    rig = load_rig(NAME, {'payload.center_of_gravity': [0.012, -0.02, 0.035]})
    slow = frequency_response(rig, 0.01)
    base = slow[:6, 6:12]
    lower = slow[6:12, 6:12]
    assert_allclose(base, lower, rtol=0.0, atol=1e-5 * np.abs(lower).max())
    # the lower sensors: u . (a + alpha x p), written out
    for i, strut in enumerate(rig.struts.each):
        foot, u = np.array(strut.foot), np.array(strut.along) / np.linalg.norm(strut.along)
        for axis in range(3):
            alpha = np.eye(3)[axis]
            assert_allclose(lower[i, axis], u[axis], atol=1e-12)
            assert_allclose(lower[i, 3 + axis], u @ np.cross(alpha, foot), atol=1e-12)


@pytest.mark.parametrize(
    'changes', [{}, SOFT_PLATE, CROOKED], ids=['rigid', 'soft plate', 'crooked']
)
def test_energy_never_grows_without_input(changes):
    """Truth: the second law; growth at most 1e-12 of the first energy (rounding), through the stops as well."""
    plant = Plant(load_rig(NAME, changes), NONE, 1)
    plant.displace(np.array([9e-3, -2e-3, 5e-3, 1e-3, -8.5e-3, 3e-3]))
    found = [float(plant.energy())]
    peaks = []
    for _ in range(150):
        peaks.append(plant.advance(np.zeros(6)).stroke_peak.max())
        found.append(float(plant.energy()))
    assert max(peaks) > 7.6e-3
    assert np.all(np.diff(found) <= 1e-12 * found[0])
    assert found[-1] < 0.2 * found[0]


def test_without_losses_energy_stays():
    """Truth: conservation; 1e-9 of the first energy over 300 samples."""
    lossless = {'struts.damping': 0.0, 'struts.stop_damping': 0.0, 'coil.force_constant': 0.0}
    plant = Plant(
        load_rig(NAME, {**CROOKED, **SOFT_PLATE, **lossless, 'shaker.damping': 0.0}), NONE, 1
    )
    plant.displace(np.array([5e-3, -2e-3, 5e-3, 1e-3, -4e-3, 3e-3]))
    start = float(plant.energy())
    for _ in range(300):
        plant.advance(np.zeros(6))
    assert_allclose(float(plant.energy()), start, rtol=1e-9)


def test_the_plant_swings_as_the_continuous_equations_say():
    """Truth: the matrix exponential of the equations (no filters, no kernel); 1e-15 m of 1 mm."""
    rig = load_rig(NAME, {**QUIET, **CROOKED, **SOFT_PLATE})
    plant = Plant(rig, NONE, 1)
    stroke = np.array([1.0, -0.5, 0.3, 0.8, -0.2, 0.6]) * 1e-3
    x = equilibrium(rig, stroke)
    E = expm(mechanics(rig).A * plant.dt)
    plant.displace(stroke)
    for _ in range(40):
        assert_allclose(plant.advance(np.zeros(6)).stroke, x[:6], rtol=0.0, atol=2e-15)
        x = E @ x


@pytest.mark.parametrize('changes', [{}, SOFT_PLATE], ids=['rigid', 'soft plate'])
def test_truth_and_readings_equal_scipys_simulation(changes):
    """Truth: scipy.signal.lsim on the state space, exact for the straight lines that drive the rig; 1e-9 of the peak.

    Six directions of the base, six forces and moments on the payload, and all coils.
    """
    quiet = {**QUIET, **CROOKED, **changes, 'acquisition.input_delay': 0.0}
    rig = load_rig(NAME, quiet)
    rng = np.random.default_rng(5)
    shape = {'kind': 'trapezoid', 'amplitude': 1.0, 'rise': 0.01, 'hold': 0.02, 'fall': 0.03}
    factors = {target: rng.normal(size=(2, 6)) for target in ('base', 'payload')}
    terms = [
        {**shape, 'start': 0.01 * i, 'target': target, 'direction': [float(v) for v in row]}
        for target, rows in factors.items()
        for i, row in enumerate(rows)
    ]
    plant = Plant(rig, make_disturbance({'kind': 'sum', 'terms': terms}), 1)
    samples, n_fine = 14, plant.n_fine
    volts = rng.uniform(-5.0, 5.0, (samples, 6))
    readings, upper, lower = [], [], []
    for k in range(samples):
        sample = plant.sample()
        readings.append([*sample.upper, *sample.lower])
        truth = plant.advance(volts[k])
        upper.append(truth.upper)
        lower.append(truth.lower)
    times = np.arange(samples * n_fine + 1) * plant.fine_period
    inputs = np.zeros((len(times), 18))
    corners = np.arange(samples + 1) * plant.dt
    for i in range(6):
        inputs[:, i] = np.interp(times, corners, [0.0, *volts[:, i]])
    for first, (target, rows) in zip((6, 12), factors.items(), strict=True):
        assert target in {'base', 'payload'}
        for i, row in enumerate(rows):
            line = np.interp(times - 0.01 * i, [0.0, 0.01, 0.03, 0.06], [0.0, 1.0, 1.0, 0.0])
            inputs[:, first : first + 6] += line[:, None] * row
    s = state_space(rig)
    _, expected, _ = lsim((s.A, s.B, s.C, s.D), inputs, times)
    expected = expected[:-1]
    close = 1e-9 * np.abs(expected).max()
    assert_allclose(np.concatenate(upper, axis=1).T, expected[:, :6], atol=close)
    assert_allclose(np.concatenate(lower, axis=1).T, expected[:, 6:12], atol=close)
    assert_allclose(np.array(readings), expected[::n_fine, 12:], atol=close)


def test_each_trial_of_a_batch_has_the_bits_of_its_single_run():
    """Truth: the single runs; equal in every bit."""
    rigs = [load_rig(NAME), load_rig(NAME, CROOKED), load_rig(NAME, {'payload.mass': 21.0})]
    shakes = [
        make_disturbance(
            {'kind': 'sine', 'frequency': 7.0, 'amplitude': 0.5, 'direction': [1.0, 0.0, 0.2]}
        ),
        NONE,
        make_disturbance(
            {'kind': 'random', 'rms': 0.3, 'low': 2.0, 'high': 40.0, 'target': 'payload'}
        ),
    ]
    batch = Plant(rigs, shakes, [1, 2, 3])
    singles = [
        Plant(rig, shake, seed) for rig, shake, seed in zip(rigs, shakes, [1, 2, 3], strict=True)
    ]
    volts = np.random.default_rng(6).normal(size=(20, 3, 6))
    for v in volts:
        sample, truth = batch.sample(), batch.advance(v)
        for i, single in enumerate(singles):
            alone, own = single.sample(), single.advance(v[i])
            assert_array_equal(sample.upper[i], alone.upper)
            assert_array_equal(sample.lower[i], alone.lower)
            assert_array_equal(truth.upper[i], own.upper)
            assert_array_equal(truth.lower[i], own.lower)


def as_listed(name, changes):
    """A rig whose struts stand on a circle, with the same struts listed."""
    rig = load_rig(name, changes)
    data = rig.to_mapping()
    feet = [
        [rig.struts.radius * float(f(np.deg2rad(angle))) for f in (np.cos, np.sin)]
        for angle in rig.struts.angles
    ]
    data['struts']['each'] = [{'foot': [*foot, 0.0], 'direction': [0.0, 0.0, 2.0]} for foot in feet]
    inertia = 0.55 * rig.payload.mass * rig.struts.radius**2
    data['payload'] |= {'inertia_tensor': [inertia] * 3, 'motions': ['z', 'rx', 'ry']}
    # under a circle the lower plate does not tilt
    data['shaker']['inertia'] = 1e15
    return rig, Rig.from_mapping(data, 'listed')


def test_struts_on_a_circle_are_a_special_case_of_listed_ones():
    """Truth: `soft_3dof` as it was before struts could be listed; readings and truth within 1e-9 of the largest."""
    changes = {**QUIET, 'payload.force_x': 0.03, 'payload.force_y': -0.05}
    circle, listed = as_listed('soft_3dof', changes)
    assert_allclose(modal_frequencies(listed), modal_frequencies(circle), rtol=1e-12)
    terms = [
        {'kind': 'random', 'rms': 1.0, 'low': 2.0, 'high': 60.0},
        {'kind': 'random', 'rms': 5.0, 'low': 2.0, 'high': 60.0, 'target': 'payload'},
    ]
    shake = make_disturbance({'kind': 'sum', 'terms': terms})
    plants = [Plant(rig, shake, 3) for rig in (circle, listed)]
    rng = np.random.default_rng(7)
    for _ in range(200):
        volts = rng.uniform(-3.0, 3.0, 3)
        samples = [plant.sample() for plant in plants]
        truths = [plant.advance(volts) for plant in plants]
        assert_allclose(samples[1].upper, samples[0].upper, rtol=0.0, atol=1e-9)
        assert_allclose(samples[1].lower, samples[0].lower, rtol=0.0, atol=1e-9)
        assert_allclose(truths[1].upper, truths[0].upper, rtol=0.0, atol=1e-9)
        assert_allclose(truths[1].lower, truths[0].lower, rtol=0.0, atol=1e-9)
        assert_allclose(truths[1].stroke, truths[0].stroke, rtol=0.0, atol=1e-12)


def test_more_struts_than_motions_stay_together():
    """Truth: strokes of a rigid payload on four struts obey s_1 - s_2 + s_3 - s_4 = 0; 1e-15 m over 2000 samples.

    Its heave is at sqrt(4 k / m) / 2 pi; 1e-12.
    """
    data = load_rig('soft_3dof', QUIET).to_mapping()
    corners = [[0.1, 0.1, 0.0], [-0.1, 0.1, 0.0], [-0.1, -0.1, 0.0], [0.1, -0.1, 0.0]]
    data['struts'] |= {
        'count': 0, 'each': [{'foot': c, 'direction': [0.0, 0.0, 1.0]} for c in corners],
        'stiffness_scale': [1.0, 1.2, 0.9, 1.1],
    }  # fmt: skip
    data['struts'].pop('damping_scale')
    data['coil'].pop('force_scale')
    data['payload'] |= {'inertia_tensor': [0.1, 0.12, 0.2], 'motions': ['z', 'rx', 'ry']}
    rig = Rig.from_mapping(data, 'table')
    assert rig.struts.count == 4
    even = rig.replace(struts=rig.struts.replace(stiffness_scale=(1.0,) * 4))
    heave = np.sqrt(4 * rig.struts.stiffness / rig.payload.mass) / (2 * np.pi)
    assert np.min(np.abs(modal_frequencies(even) - heave)) < 1e-12 * heave
    plant = Plant(
        rig, make_disturbance({'kind': 'random', 'rms': 1.0, 'low': 2.0, 'high': 50.0}), 1
    )
    rng = np.random.default_rng(8)
    largest = 0.0
    for _ in range(2000):
        stroke = plant.advance(rng.uniform(-3.0, 3.0, 4)).stroke
        largest = max(largest, np.abs(stroke).max())
        assert abs(stroke[0] - stroke[1] + stroke[2] - stroke[3]) < 1e-15
    assert largest > 1e-4


def test_the_response_of_all_struts_has_six_directions_of_each_source():
    """Truth: the continuous response of the state space, which the other tests hold; 1e-12."""
    rig = load_rig(NAME)
    found = rig_response(rig, [3.0, 20.0])
    both = frequency_response(rig, np.array([3.0, 20.0]))
    assert found.true_source.shape == (2, 6, 12)
    assert_allclose(found.true_source, both[:, :6, 6:18], rtol=1e-12)
    assert state_space(rig).inputs[6:8] == ('base_x', 'base_y')
    assert state_space(rig).outputs[6] == 'lower_1'
