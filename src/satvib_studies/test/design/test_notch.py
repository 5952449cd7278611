# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The fixed notch, the search of both designs, and what integral force feedback would be on this rig."""

import cmath
import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from satvib_bringup.cli import main as cli
from satvib_common.errors import SatvibError
from satvib_common.signals.integrator import leaky_integrator
from satvib_common.struts.motions import mode_matrix, strut_matrix
from satvib_control.laws.state_space.matrices import Matrices, response
from satvib_experiment.scenario.scenario import load_scenario
from satvib_plant_sim.physics.mechanics import mechanics
from satvib_plant_sim.responses.all_struts import rig_response
from satvib_plant_sim.rig.rig import load_rig
from satvib_studies.design.closed_loop import closed_loop_poles, for_every_strut
from satvib_studies.design.notch import FORGETS, design_notch
from satvib_studies.design.search import DesignSearch, DesignSettings, stable

DT = 1.0 / 200.0
BOTH = {
    'kind': 'sum',
    'terms': [
        {'kind': 'sine', 'frequency': 9.0, 'amplitude': 0.5},
        {'kind': 'random', 'low': 2.0, 'high': 50.0, 'rms': 0.2},
    ],
}


@pytest.mark.parametrize('frequency', [0.3, 9.0, 8.9, 40.0])
def test_the_controller_is_the_stated_filter(frequency):
    """Truth: H, H^2 and the rotating number in closed form; 1e-9 of its magnitude."""
    gains, gain, phase, width = (40.0, 900.0, 0.3), 0.02, 0.7, 0.2
    matrices = design_notch(gains, 0.5, 9.0, width, gain, phase, DT)
    omega = 2.0 * math.pi * frequency * DT
    z = cmath.exp(1j * omega)
    b, a = leaky_integrator(0.5, DT)
    H = np.polyval(b[::-1], 1.0 / z) / np.polyval(a[::-1], 1.0 / z)
    r, w = math.exp(-math.pi * width * DT), 2.0 * math.pi * 9.0 * DT
    one = cmath.exp(1j * phase) / (1.0 - r * cmath.exp(1j * w) / z)
    other = cmath.exp(-1j * phase) / (1.0 - r * cmath.exp(-1j * w) / z)
    truth = -(gains[2] + gains[0] * H + gains[1] * H * H) - 0.5 * gain * (one + other)
    found = response(matrices, np.array(omega))[0, 0]
    assert abs(found - truth) < 1e-9 * abs(truth)


def test_it_does_not_wind_up_at_0_volts():
    """Truth: its poles. A resonator whose own decay takes 300 s decays in 0.3 s where the voltage is not applied."""
    matrices = design_notch((40.0, 500.0, 0.1), 0.5, 9.0, 1e-3, 0.02, 0.4, DT)
    own = np.abs(np.linalg.eigvals(matrices.linear()[0]))
    assert own.max() == pytest.approx(math.exp(-math.pi * 1e-3 * DT), abs=1e-9)
    held = np.linalg.eigvals(matrices.A)
    turning = held[np.abs(np.angle(held) - 2.0 * math.pi * 9.0 * DT) < 0.05]
    assert np.abs(turning) == pytest.approx([math.exp(-DT / FORGETS)], rel=1e-6)
    # four poles of the integrators in one place are known to the fourth root of the precision
    assert np.abs(held).max() < math.exp(-DT / 0.4)


def test_a_notch_without_gain_is_the_damper():
    """Truth: P alone, in closed form."""
    b, a = leaky_integrator(0.5, DT)
    z = np.exp(-1j * np.array([0.1, 0.3]))
    matrices = design_notch((40.0, 0.0, 0.0), 0.5, 9.0, 0.1, 0.0, 0.0, DT)
    found = response(matrices, np.array([0.1, 0.3]))[:, 0, 0]
    assert found == pytest.approx(-40.0 * np.polyval(b[::-1], z) / np.polyval(a[::-1], z))


def test_a_notch_is_where_the_tone_is():
    """Truth: |S| from the rig's exact response: at 9 Hz much less than at 8 and 10 Hz, and a stable loop."""
    rig = load_rig('soft_3dof')
    f = np.array([8.0, 9.0, 10.0])
    damper = design_notch((56.0, 0.0, 0.0), 0.5, 9.0, 1e-3, 0.0, 0.0, DT)
    r = rig_response(rig, f)
    eye = np.eye(3)

    def closed(matrices):
        law = -response(matrices, 2.0 * np.pi * f * DT) * eye
        return np.linalg.inv(eye + r.read_voltage @ law)

    # the voltage of the notch meets the tone when its phase is opposite to that of the damped rig
    damped = (closed(damper) @ r.read_voltage)[1, 0, 0]
    made = design_notch((56.0, 0.0, 0.0), 0.5, 9.0, 1e-3, 0.01, -cmath.phase(complex(damped)), DT)
    assert np.abs(closed_loop_poles(rig, for_every_strut(made, 3))).max() < 1.0
    S = np.linalg.norm(closed(made), 2, axis=(1, 2))
    assert S[1] < 0.02 * min(S[0], S[2])


def test_every_strut_has_its_own():
    """Truth: block by block."""
    one = Matrices(*(np.array([[v]]) for v in (0.5, 1.0, 2.0, 3.0, 4.0)))
    three = for_every_strut(one, 3)
    assert np.array_equal(three.A, 0.5 * np.eye(3))
    assert np.array_equal(three.D, 3.0 * np.eye(3))


def test_force_feedback_would_be_a_point_of_the_modal_law():
    """On a rigid payload the forces of the struts are f = H^-1 a, H from forces to accelerations.

    So the integral of all forces is the modal law with P alone, proportional to the modal masses m / 3 and
    2 J / (3 r^2). Truth: H of the rig's equations of motion; 1e-12.
    """
    rig = load_rig('soft_3dof')
    m = mechanics(rig)
    J, r = m.M[1, 1], rig.struts.radius
    masses = np.diag([m.M[0, 0] / 3.0, 2.0 * J / (3.0 * r * r), 2.0 * J / (3.0 * r * r)])
    angles = rig.struts.angles
    modal = strut_matrix(angles) @ masses @ mode_matrix(angles)
    assert modal == pytest.approx(np.linalg.inv(m.H), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize('design', ['lqg', 'notch'])
def test_a_search_beats_its_start_and_is_stable_on_all_plants(design):
    """Truth: the figures of the start; and the poles of each loop."""
    settings = {'design': design, 'cost': {'plants': 2}, 'swarm': {'budget': 40, 'particles': 10}}
    search = DesignSearch(load_rig('soft_3dof'), BOTH, DesignSettings.from_mapping(settings))
    found = search.run()
    rows = found.summary()
    assert rows['tuned']['cost'] < rows['untuned']['cost']
    assert rows['tuned']['stable_plants'] == 2.0
    assert stable(search.judge(found.result.position)[1]).all()
    assert search(found.result.position[None])[0] == found.result.cost


def run_command(monkeypatch, *arguments):
    """Exit code of the command."""
    monkeypatch.setattr('sys.argv', ['satvib', *arguments])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    return ended.value.code or 0


def test_the_command_writes_a_controller_that_a_scenario_takes(tmp_path: Path, monkeypatch):
    """Truth: the file's own numbers come back in the controller's parameters, for one strut."""
    folder = tmp_path / 'notch'
    arguments = [
        'tune',
        '--design',
        'notch',
        '--rig',
        'soft_3dof',
        '--disturbance',
        str(BOTH).replace("'", ''),
    ]
    for setting in ('swarm.budget=12', 'swarm.particles=6', 'cost.plants=1'):
        arguments += ['--set', setting]
    assert run_command(monkeypatch, *arguments, '--folder', str(folder)) == 0
    data = yaml.safe_load((folder / 'gains.yaml').read_text())
    assert (folder / 'tuning.png').stat().st_size > 10_000
    changes = ['controller.law=state_space', f'controller.file={folder / "gains.yaml"}']
    p = load_scenario('soft_3dof', changes).controller_parameters(200.0)
    assert p.law == 'state_space'
    assert list(p.state_space_a) == data['controller']['state_space_a']
    assert len(p.state_space_a) == 36


BAD = {
    'no tone': (
        {'kind': 'random', 'low': 2.0, 'high': 50.0, 'rms': 0.5},
        {},
        'the disturbance has no tones',
    ),
    'high': (BOTH, {'tone': 120.0}, 'tone: 120.0 Hz is not below half the sample rate'),
    'years': (BOTH, {'swarm': {'budget': 10**15}}, 'swarm.budget'),
}


@pytest.mark.parametrize('case', BAD)
def test_what_cannot_be_designed_is_refused_in_one_line(case):
    disturbance, settings, said = BAD[case]
    with pytest.raises(SatvibError) as refused:
        DesignSearch(load_rig('soft_3dof'), disturbance, DesignSettings.from_mapping(settings))
    assert said in str(refused.value)
    assert '\n' not in str(refused.value)
