# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Six struts: a base that moves sideways, and one that moves in several directions at once."""

from dataclasses import replace

import numpy as np
import pytest
from satvib_experiment.frf.curve import OPEN, TRANSMISSIBILITY
from satvib_experiment.frf.how import base_directions
from satvib_experiment.frf.measure import measure_recording, measure_scenario
from satvib_experiment.frf.measurement import MeasurementSettings, base_scenario
from satvib_experiment.frf.output import frf_mapping
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate
from satvib_ident.frequency.settings import FrfSettings
from satvib_plant_sim.disturbance.factory import make_disturbance

REST = ['duration=2', 'phases=[{phase: CALIBRATE}]', 'disturbance={}', 'analysis={}']


@pytest.fixture(scope='module')
def sideways():
    """The base moves along x, open loop and under 0 V."""
    settings = MeasurementSettings(
        duration=9.0, period=3.0, settle=3.0, low=2.0, high=40.0, direction=(1.0, 0.0, 0.0)
    )
    scenario = load_scenario('hexapod_6dof', REST)
    return measure_scenario(scenario, simulate, settings, FrfSettings(), ('off',), ('base',))


def test_a_base_that_moves_sideways_gives_the_exact_response_sideways(sideways):
    """Truth: the rig's exact response to a base along x; 0.3 dB and 2 degrees where the coherence is above 0.99."""
    curves = {c.output: c for c in sideways.curves if c.loop == OPEN}
    x = curves['x']
    assert x.input == 'base_x'
    db, degrees = x.deviation()
    assert db < 0.3
    assert degrees < 2.0
    assert np.sum(x.measured.coherence > 0.99) > 100


def test_a_strut_across_the_motion_has_no_transmissibility(sideways):
    """Truth: struts 1 and 4 lie in a plane across x, so their feet do not move along them."""
    struts = {c.output for c in sideways.curves if c.loop == OPEN and c.output.startswith('strut')}
    assert struts == {'strut_2', 'strut_3', 'strut_5', 'strut_6'}


def test_only_a_motion_of_the_base_itself_has_a_roll_off(sideways):
    """Truth: payload along x over base along x isolates above its mode; a turn is a share of nothing."""
    rows = {c['output']: c for c in frf_mapping(sideways.curves, '')['curves'] if c['loop'] == OPEN}
    assert rows['x']['merit']['roll_off'] < -30.0
    for other in ('y', 'heave', 'tilt_x', 'tilt_y', 'rz'):
        assert rows[other]['merit'] is None or rows[other]['merit']['roll_off'] is None


def test_directions_count_once_whatever_their_length_and_sign():
    """Truth: two terms along one line, one across it, one on the payload, one that is over."""
    shake = make_disturbance(
        {
            'kind': 'sum',
            'terms': [
                {'kind': 'sine', 'frequency': 5.0, 'amplitude': 1.0, 'direction': [0.6, 0.0, 0.8]},
                {'kind': 'sine', 'frequency': 6.0, 'amplitude': 1.0, 'direction': [-3.0, 0.0, -4.0]},
                {'kind': 'sine', 'frequency': 7.0, 'amplitude': 1.0, 'direction': [0.0, 2.0, 0.0]},
                {'kind': 'sine', 'frequency': 7.0, 'amplitude': 1.0, 'target': 'payload', 'direction': [1, 0, 0]},
                {'kind': 'sine', 'frequency': 7.0, 'amplitude': 1.0, 'stop': 2.0, 'direction': [1.0, 0.0, 0.0]},
            ],
        },
        'here',
    )  # fmt: skip
    found = base_directions(shake, 3.0, 9.0)
    assert np.allclose(found, [[0.6, 0.0, 0.8, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]])


def test_a_base_that_moves_in_several_directions_at_once():
    """Independent noise along x and about y: each motion over its own. Truth: nothing exact is claimed; it is said."""
    noise = {'kind': 'random', 'low': 2.0, 'high': 60.0, 'rms': 0.5, 'start': 1.0}
    terms = [{**noise, 'direction': d} for d in ([1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 4.0, 0.0])]
    scenario = load_scenario('hexapod_6dof', [*REST, 'duration=25']).replace(
        disturbance={'kind': 'sum', 'terms': terms}
    )
    run = simulate(scenario)
    found = measure_recording(run, FrfSettings(resolution=0.5))
    motions = {c.output: c for c in found.curves if not c.output.startswith('strut')}
    assert all(c.exact is None for c in found.curves if c.quantity == TRANSMISSIBILITY)
    assert motions['x'].input == 'base_x'
    assert motions['tilt_y'].input == 'base_tilt_y'
    assert 'heave' not in motions
    assert any('2 directions at once' in note for note in found.notes)
    assert np.median(motions['x'].measured.coherence) > 0.9
    # the same samples from elsewhere: what moved the base is not known
    found = measure_recording(replace(run, scenario=None), FrfSettings(resolution=0.5))
    assert all(c.exact is None for c in found.curves if c.quantity == TRANSMISSIBILITY)
    assert {c.input for c in found.curves if c.output == 'x'} == {'base_x'}


def test_lines_that_are_too_far_apart_are_said():
    """Segments of 0.2 s have lines 5 Hz apart. Truth: the modes are about 0.7 Hz wide; with 0.2 Hz nothing is said."""
    noise = {'kind': 'random', 'low': 2.0, 'high': 60.0, 'rms': 0.5, 'start': 1.0}
    run = simulate(load_scenario('hexapod_6dof', [*REST, 'duration=25']).replace(disturbance=noise))
    for resolution, said in ((5.0, True), (0.2, False)):
        notes = measure_recording(run, FrfSettings(resolution=resolution)).notes
        assert any('too far for the peaks' in note for note in notes) == said


def test_one_stretch_alone_begins_with_the_base():
    """Truth: the plan: the base moves from the end of CALIBRATE on, and is measured after it has settled."""
    settings = MeasurementSettings(duration=9.0, period=3.0, settle=3.0)
    scenario = load_scenario('hexapod_6dof', REST)
    for loop, phase, window in (
        ('open', 'STANDBY', 'uncontrolled'),
        ('closed', 'CONTROL', 'controlled'),
    ):
        made = base_scenario(scenario, settings, loops=(loop,))
        assert [(p.phase, p.start) for p in made.phases] == [('CALIBRATE', 0.0), (phase, 2.0)]
        assert getattr(made.analysis, window) == (5.0, 14.0)
        assert made.duration == 14.0
        assert made.disturbance['start'] == 2.0
