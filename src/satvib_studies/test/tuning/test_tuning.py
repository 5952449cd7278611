# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Tuning: the cost against independent computations and the twin, the search, the command."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from satvib_bringup.cli import main as cli
from satvib_common.errors import SatvibError
from satvib_common.signals.integrator import leaky_integrator
from satvib_common.struts.motions import mode_matrix, strut_matrix
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.responses.all_struts import rig_response, sampled_rig
from satvib_plant_sim.rig.rig import load_rig
from satvib_studies.tuning.cost import CostSettings, TuningCost
from satvib_studies.tuning.figure import closed_transmission
from satvib_studies.tuning.loop_cost import LoopFigure
from satvib_studies.tuning.particle_swarm import ParticleSwarm, SwarmSettings
from satvib_studies.tuning.plants import perturbed
from satvib_studies.tuning.search import UNTUNED, Search, TuneSettings, summary
from scipy.optimize import differential_evolution
from scipy.signal import tf2ss

TONE = {'kind': 'sine', 'frequency': 9.0, 'amplitude': 0.5}
RANDOM = {'kind': 'random', 'low': 2.0, 'high': 50.0, 'rms': 0.5}


@pytest.fixture(scope='module')
def cost():
    return TuningCost(load_rig('soft_3dof'), make_disturbance(TONE), CostSettings(plants=3))


def drawn(cost, count, seed=1, part=0.3):
    """Gains within a part of the box above its lower corner."""
    draw = np.random.default_rng(seed).random((count, cost.size))
    return cost.lower + part * (cost.upper - cost.lower) * draw


def closed_loop_poles(rig, gains, corner):
    """Poles of the sampled loop, from state-space models of the rig and of the law put together."""
    n = rig.struts.count
    plant = sampled_rig(rig)
    b, a = leaky_integrator(corner, plant.dt)
    b, a = np.array(b), np.array(a)
    T, mode = strut_matrix((90.0, 210.0, 330.0)), mode_matrix((90.0, 210.0, 330.0))
    laws = [
        tf2ss(gains[2, m] * np.convolve(a, a) + gains[0, m] * np.convolve(b, a)
              + gains[1, m] * np.convolve(b, b), np.convolve(a, a))
        for m in range(n)
    ]  # fmt: skip
    size, order, taps = len(plant.A), 4, plant.late + len(plant.B)
    total = size + n * order + n * taps
    A = np.zeros((total, total))
    law, past = size, size + n * order
    # rows of u(k) over the state
    u = np.zeros((n, total))
    for m in range(n):
        Am, Bm, Cm, Dm = laws[m]
        s = slice(law + m * order, law + (m + 1) * order)
        A[s, s] = Am
        A[s, :size] = Bm @ (mode[m : m + 1] @ plant.C)
        u[:, s] -= np.outer(T[:, m], Cm[0])
        u[:, :size] -= Dm[0, 0] * np.outer(T[:, m], mode[m] @ plant.C)
    A[:size, :size] = plant.A
    for i, B in enumerate(plant.B):
        late = plant.late + i
        if late == 0:
            A[:size] += B @ u
        else:
            A[:size, past + (late - 1) * n : past + late * n] += B
    A[past : past + n] = u
    for i in range(1, taps):
        A[past + i * n : past + (i + 1) * n, past + (i - 1) * n : past + i * n] = np.eye(n)
    return np.linalg.eigvals(A)


def test_stability_is_that_of_the_closed_loop_poles(cost):
    """Truth: the poles of the sampled closed loop, another way; 60 draws with both kinds among them."""
    scale = np.random.default_rng(8).uniform(0.0, 0.3, (60, 1))
    gains = scale * cost.upper * np.random.default_rng(9).uniform(-0.1, 1.0, (60, 9))
    turns = cost.figures(gains)[..., LoopFigure.TURNS]
    seen = []
    for i, g in enumerate(gains):
        for j, plant in enumerate(cost.plants[:2]):
            radius = np.abs(closed_loop_poles(plant, g.reshape(3, 3), 0.5)).max()
            if abs(radius - 1.0) < 1e-4:
                continue  # on the very edge
            assert (abs(turns[i, j]) < 0.5) == (radius < 1.0), (i, j, radius)
            seen.append(radius < 1.0)
    assert 10 < sum(seen) < len(seen) - 10


def test_the_kernel_is_the_textbook_loop(cost):
    """Truth: NumPy's inverse and singular values at the same frequencies; 1e-9."""
    gains = drawn(cost, 4, seed=2, part=0.1)
    figures = cost.figures(gains)
    f = cost.frequency
    T, mode = cost._strut, cost._mode
    z = np.exp(-2j * np.pi * f / 200.0)
    b, a = leaky_integrator(0.5, 1.0 / 200.0)
    H = (np.polyval(b[::-1], z) / np.polyval(a[::-1], z))[:, None]
    r = rig_response(cost.rig, f)
    for g, found in zip(gains.reshape(-1, 3, 3), figures[:, 0], strict=True):
        C = T @ ((g[2] + g[0] * H + g[1] * H * H)[:, :, None] * mode)
        loop = np.eye(3) + r.read_voltage @ C
        assert found[LoopFigure.MARGIN] == pytest.approx(
            np.linalg.svd(loop)[1][:, -1].min(), rel=1e-9
        )
        CS = -C @ np.linalg.inv(loop)
        u = CS @ r.read_source[:, :, :1]
        power = np.abs(u[:, :, 0]) ** 2 * cost.power[:, :1]
        power += np.sum(np.abs(CS) ** 2, axis=2) * cost.noise[:, None]
        assert found[LoopFigure.VOLTS] == pytest.approx(
            math.sqrt(power.sum(axis=0).max()), rel=1e-9
        )


def test_six_struts_are_judged_likewise():
    """Truth: NumPy's inverse and singular values; the margin 2e-4, which its powers allow, the rest 1e-9."""
    terms = [
        {'kind': 'sine', 'frequency': 7.0, 'amplitude': 0.3, 'direction': [0.8, 0.0, 0.6]},
        {'kind': 'sine', 'frequency': 9.0, 'amplitude': 2.0, 'target': 'payload',
         'direction': [0.0, 0.0, 0.0, 0.1, 0.0, 0.2]},
    ]  # fmt: skip
    shake = make_disturbance({'kind': 'sum', 'terms': terms})
    cost = TuningCost(load_rig('hexapod_6dof'), shake, CostSettings(plants=2))
    assert cost.size == 18
    assert cost.power.shape[1] == 2
    gains = drawn(cost, 3, seed=2, part=0.1)
    f, T, mode = cost.frequency, cost._strut, cost._mode
    z = np.exp(-2j * np.pi * f / 200.0)
    b, a = leaky_integrator(0.5, 1.0 / 200.0)
    H = (np.polyval(b[::-1], z) / np.polyval(a[::-1], z))[:, None]
    r = rig_response(cost.rig, f)
    factors = np.zeros((12, 2))
    factors[[0, 2], 0] = 0.8, 0.6
    factors[[9, 11], 1] = 0.1, 0.2
    for g, found in zip(gains.reshape(-1, 3, 6), cost.figures(gains)[:, 0], strict=True):
        C = T @ ((g[2] + g[0] * H + g[1] * H * H)[:, :, None] * mode)
        loop = np.eye(6) + r.read_voltage @ C
        margin = np.linalg.svd(loop)[1][:, -1].min()
        assert found[LoopFigure.MARGIN] == pytest.approx(margin, rel=2e-4)
        CS = -C @ np.linalg.inv(loop)
        u = CS @ r.read_source @ factors
        power = np.abs(u) ** 2 * cost.power[:, None, :]
        noise = np.sum(np.abs(CS) ** 2, axis=2) * cost.noise[:, None]
        assert found[LoopFigure.VOLTS] == pytest.approx(
            math.sqrt((power.sum(axis=2) + noise).sum(axis=0).max()), rel=1e-9
        )
        q = mode @ (r.true_source @ factors + r.true_voltage @ u)
        heard = mode @ r.true_voltage @ CS
        levels = np.sum(np.abs(q) ** 2 * cost.power[:, None, :], axis=2)
        levels += np.sum(np.abs(heard) ** 2, axis=2) * cost.noise[:, None]
        assert found[LoopFigure.MODES :] == pytest.approx(np.sqrt(levels.sum(axis=0)), rel=1e-9)
        tilt = levels[:, 3:5].sum(axis=1) / (2 * np.pi * f) ** 4
        assert found[LoopFigure.TILT] == pytest.approx(math.sqrt(tilt.sum()), rel=1e-9)


def test_levels_are_those_of_the_twin(cost):
    """Truth: the time-domain twin, its fine truth over whole periods of the tone; 2 %, with and without control."""
    for gains in (np.zeros(9), np.array([56.0] * 3 + [1000.0, 0.0, 0.0] + [0.2] * 3)):
        rows = gains.reshape(3, 3).tolist()
        settings = [
            'name=check', 'scheme=centralized', 'duration=8', 'seed=2',
            f'centralized={{gains_p: {rows[0]}, gains_i: {rows[1]}, gains_d: {rows[2]}}}',
            'phases=[{phase: CALIBRATE}, {phase: CONTROL, start: 1}]', 'controller={}',
            'disturbance={kind: sine, frequency: 9.0, amplitude: 0.5, start: 1.0}',
            'analysis={}',
        ]  # fmt: skip
        run = simulate(load_scenario('soft_3dof', settings))
        truth = run.get('truth', 'upper')[run.window(6.0, 8.0)]
        modes = np.einsum('mi,kif->mkf', mode_matrix((90.0, 210.0, 330.0)), truth)
        found = np.sqrt(np.mean(modes**2, axis=(1, 2)))
        figures = cost.figures(gains[None])[0, 0]
        assert found[0] == pytest.approx(figures[LoopFigure.MODES], rel=0.02)
        # tilts are small; what is left of the onset and of the noise shows in them
        assert found == pytest.approx(
            figures[LoopFigure.MODES : LoopFigure.MODES + 3], abs=0.03 * figures[LoopFigure.MODES]
        )


def test_cost_does_not_depend_on_who_else_is_in_the_swarm(cost):
    """Truth: one particle alone, bit for bit."""
    gains = drawn(cost, 7, seed=3)
    whole = cost(gains)
    assert np.array_equal(whole, [cost(g[None])[0] for g in gains])


def test_perturbed_plants_are_what_is_said():
    """Truth: the stated ranges; the first is the rig, and plant i is the same in every set."""
    rig = load_rig('soft_3dof')
    few, many = perturbed(rig, 4, 7), perturbed(rig, 40, 7)
    assert few[0] is rig
    assert few == many[:4]
    masses = np.array([p.payload.mass for p in many]) / rig.payload.mass
    assert 0.7 <= masses.min() < 0.8
    assert 1.2 < masses.max() <= 1.3
    ratio = np.array([p.struts.stiffness_scale for p in many]) / rig.struts.stiffness_scale
    assert ratio.min() >= 0.8 * 0.9
    assert ratio.max() <= 1.2 * 1.1


@pytest.mark.parametrize('disturbance', [TONE, RANDOM], ids=['tone', 'random'])
def test_tuned_gains_beat_the_untuned_ones_on_every_count(disturbance):
    """Truth: the untuned gains' own figures. Better in cost, better on the worst plant, margins as wanted."""
    settings = TuneSettings.from_mapping(
        {'cost': {'plants': 4}, 'swarm': {'budget': 1500, 'particles': 20}}
    )
    found = Search(load_rig('soft_3dof'), disturbance, settings).run()
    told = summary(found)
    assert told['tuned']['cost'] < 0.8 * told['untuned']['cost']
    assert told['tuned']['attenuation'] < told['untuned']['attenuation'] - 1.0
    assert told['tuned']['margin_worst_plant'] > 0.4
    assert found.untuned[:3] == pytest.approx(UNTUNED)


@pytest.mark.long
def test_the_swarm_is_no_straw_man():
    """Truth: scipy's differential evolution at the same budget, three seeds; the median within 5 % of its median."""
    cost = TuningCost(load_rig('soft_3dof'), make_disturbance(TONE), CostSettings(plants=3))
    budget, size = 2700, 5 * cost.size
    mine, theirs = [], []
    for seed in (1, 2, 3):
        chosen = SwarmSettings(seed=seed, budget=budget, patience=0)
        mine.append(ParticleSwarm(cost.lower, cost.upper, chosen).run(cost).cost)
        found = differential_evolution(
            lambda x: cost(x.T), list(zip(cost.lower, cost.upper, strict=True)), popsize=5,
            maxiter=budget // size - 1, tol=0.0, polish=False, vectorized=True,
            updating='deferred', rng=seed,
        )  # fmt: skip
        assert found.nfev <= budget
        theirs.append(found.fun)
    assert np.median(mine) < 1.05 * np.median(theirs)


def test_a_transmission_without_gains_is_that_of_the_rig():
    """Truth: the rig's response; identical."""
    rig = load_rig('soft_3dof')
    f = np.array([1.0, 9.0, 30.0])
    open_ = np.abs(mode_matrix((90.0, 210.0, 330.0)) @ rig_response(rig, f).true_source[:, :, :1])
    assert closed_transmission(rig, np.zeros((3, 3)), 0.5, f) == pytest.approx(open_[:, :, 0])


def run_command(monkeypatch, *arguments):
    """Exit code of the command."""
    monkeypatch.setattr('sys.argv', ['satvib', *arguments])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    return ended.value.code or 0


SHORT = ('--set', 'swarm.budget=48', '--set', 'cost.plants=2')


def test_the_command_writes_gains_that_a_scenario_takes(tmp_path: Path, monkeypatch, capsys):
    """Truth: the file's own numbers come back in the controller's parameters; nothing is overwritten."""
    folder = tmp_path / 'tuned'
    arguments = ('tune', '--rig', 'soft_3dof', '--disturbance', str(TONE).replace("'", ''))
    assert run_command(monkeypatch, *arguments, *SHORT, '--folder', str(folder)) == 0
    data = yaml.safe_load((folder / 'gains.yaml').read_text())
    assert (folder / 'tuning.png').stat().st_size > 10_000
    assert data['cost_history'][-1][1] == pytest.approx(data['figures']['tuned']['cost'], rel=1e-4)
    file = folder / 'gains.yaml'
    scenario = load_scenario(
        'soft_3dof',
        ['scheme=centralized', f'centralized.file={file}', 'centralized.gains_i=[1,2,3]'],
    )
    p = scenario.controller_parameters(200.0)
    assert list(p.gains_p) == data['centralized']['gains_p']
    assert p.gains_i == (1.0, 2.0, 3.0)
    before = file.read_bytes()
    assert run_command(monkeypatch, *arguments, *SHORT, '--folder', str(folder)) == 2
    assert 'exists already' in capsys.readouterr().err
    assert file.read_bytes() == before


BAD = {
    'rig': (('--rig', 'soft_4dof', '--disturbance', '{kind: none}'), 'no such rig'),
    'silence': (('--rig', 'soft_3dof', '--disturbance', '{kind: none}'), 'at rest'),
    'kind': (('--rig', 'soft_3dof', '--disturbance', '{kind: sinus}'), "'sinus' is not known"),
    'text': (('--rig', 'soft_3dof', '--disturbance', 'nine hertz'), 'a scenario, a YAML file'),
    'setting': (
        ('--rig', 'soft_3dof', '--disturbance', 'soft_3dof', '--set', 'swarm.budgett=3'),
        'did you mean budget?',
    ),
    'margin': (
        ('--rig', 'soft_3dof', '--disturbance', 'soft_3dof', '--set', 'cost.margin=2'),
        'cost.margin: 2.0 is not below 1.0',
    ),
}


@pytest.mark.parametrize('case', BAD)
def test_bad_input_is_one_line_and_exit_2(case, tmp_path, monkeypatch, capsys):
    """Nothing is written, and the line says what is wrong."""
    arguments, told = BAD[case]
    folder = tmp_path / 'out'
    assert run_command(monkeypatch, 'tune', *arguments, '--folder', str(folder)) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count('\n') == 1
    assert not folder.exists()


def test_a_corrupt_checkpoint_is_refused_and_a_good_one_gone_on_from(tmp_path, monkeypatch, capsys):
    """Truth: the run that was never interrupted: the same gains; a broken file is left alone, exit 2."""
    arguments = (
        'tune',
        '--rig',
        'soft_3dof',
        '--disturbance',
        'soft_3dof',
        '--set',
        'cost.plants=2',
    )
    file = tmp_path / 'search.npz'
    for budget, folder in ((480, 'half'), (960, 'whole')):
        more = ('--set', f'swarm.budget={budget}', '--checkpoint', str(file))
        assert run_command(monkeypatch, *arguments, *more, '--folder', str(tmp_path / folder)) == 0
    assert (
        run_command(
            monkeypatch, *arguments, '--set', 'swarm.budget=960', '--folder', str(tmp_path / 'once')
        )
        == 0
    )
    assert (tmp_path / 'whole/gains.yaml').read_text() == (tmp_path / 'once/gains.yaml').read_text()
    file.write_bytes(b'PK broken')
    capsys.readouterr()
    code = run_command(
        monkeypatch, *arguments, '--checkpoint', str(file), '--folder', str(tmp_path / 'no')
    )
    assert code == 2
    assert 'not a checkpoint' in capsys.readouterr().err
    assert file.read_bytes() == b'PK broken'
    assert not (tmp_path / 'no').exists()


def test_identified_models_cannot_be_tuned():
    """A rig of models has no modes; the error says so."""

    class Models:
        name = 'models'

    with pytest.raises(SatvibError, match='identified models have no modes'):
        Search(Models(), TONE)
