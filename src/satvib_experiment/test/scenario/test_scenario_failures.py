# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Failures and schemes in scenarios: what the twin makes of them, and what is refused before anything starts."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_experiment.recording.recording import differences
from satvib_experiment.scenario.scenario import Scenario, load_scenario
from satvib_experiment.twin.closed_loop import simulate, simulate_batch, simulate_open_loop

SHORT = [
    'name=short',
    'duration=4',
    'phases=[{phase: CALIBRATE}, {phase: CONTROL, start: 0.5}]',
    'disturbance.start=0.5',
    'controller={law: velocity_feedback}',
    'analysis={}',
]
CENTRAL = ['scheme=centralized', 'centralized={gains_p: [56, 56, 56]}']


def short(*more):
    return load_scenario('soft_3dof', [*SHORT, *more])


def failing(text, *more):
    return short(f'failures=[{text}]', *more)


@pytest.mark.parametrize('scheme', [[], CENTRAL], ids=['decentralized', 'centralized'])
def test_a_batch_with_failures_equals_the_single_runs(scheme):
    """Truth: each scenario alone, bit for bit, every kind of failure among them."""
    kinds = [
        '{kind: actuator_lost, strut: 1, time: 1.0}',
        '{kind: sensor_lost, strut: 2, time: 1.0}',
        '{kind: rig_changed, time: 1.5, changes: {payload.mass: 11.7}}',
        '{kind: disturbance_changed, time: 1.2, disturbance: {kind: sine, frequency: 12, amplitude: 0.5}}',
        '{kind: controller_killed, strut: 3, time: 2.0}',
        '{kind: controller_killed, time: 2.0}',
    ]
    scenarios = [short(*scheme), *(failing(kind, *scheme) for kind in kinds)]
    for scenario, run in zip(scenarios, simulate_batch(scenarios), strict=True):
        assert differences(run, simulate(scenario)) == []


def test_one_dead_controller_of_three_leaves_two_and_a_dead_centralized_one_none():
    """Truth: the messages: after the death nothing is there from the dead, and everything from the living."""
    k = 400
    one = simulate(failing('{kind: controller_killed, strut: 2, time: 2.0}'))
    all_ = simulate(failing('{kind: controller_killed, time: 2.0}', *CENTRAL))
    for run, dead in ((one, [1]), (all_, [0, 1, 2])):
        for group in ('voltage', 'state'):
            present = run.get(group, 'present')
            assert present[:k].all()
            assert not present[k:, dead].any()
            assert present[k:].sum() == (3 - len(dead)) * (len(present) - k)
        assert run.get('acceleration', 'present').all()
        assert np.isfinite(run.get('truth', 'upper')).all()
    level = np.abs(one.get('truth', 'upper')[-200:]).max(axis=(0, 2))
    gone = np.abs(all_.get('truth', 'upper')[-200:]).max(axis=(0, 2))
    assert (level[[0, 2]] < 0.5 * gone[[0, 2]]).all()


def test_the_open_loop_twin_has_the_failures_of_the_rig():
    """Truth: a run with the law off, which is the open loop, with the same changes on the way; bit for bit."""
    text = (
        '{kind: rig_changed, time: 1.5, changes: {payload.mass: 11.7}},'
        '{kind: disturbance_changed, time: 2, disturbance: {kind: sine, frequency: 12, amplitude: 1}}'
    )
    off = simulate(failing(text, 'controller.law=off'))
    twin = simulate_open_loop(simulate(failing(text)))
    assert np.array_equal(off.get('truth', 'upper'), twin.get('truth', 'upper'))
    assert np.array_equal(off.get('acceleration', 'upper'), twin.get('acceleration', 'upper'))


def test_scenarios_with_failures_come_back_from_their_mapping():
    """Truth: the scenario itself."""
    scenario = failing('{kind: rig_changed, time: 1.5, changes: {payload.mass: 11.7}}', *CENTRAL)
    assert Scenario.from_mapping(scenario.to_mapping()) == scenario


BAD = {
    'failures=[{kind: sensor_lost, strut: 4, time: 1}]': 'failures[0].strut: 4, but soft_3dof has 3',
    'failures=[{kind: sensor_lost, time: 1}]': 'failures[0].strut: missing',
    'failures=[{kind: sensor_lost, strut: 1, time: 9}]': 'the run ends at 4.0 s',
    'failures=[{kind: lost, time: 1}]': "failures[0].kind: 'lost' is not one of",
    'failures=[{kind: rig_changed, time: 1, changes: {payload.mas: 1}}]': 'payload.mas: no such key',
    'failures=3': 'failures: ',
    'scheme=central': "scheme: 'central' is not one of",
    'centralized.strut_angles=[1,2,3]': 'centralized.strut_angles: the rig sets it',
    'centralized.file=nothing.yaml': 'nothing.yaml: cannot be read',
}


@pytest.mark.parametrize('override', BAD)
def test_what_is_wrong_is_said_in_one_line(override):
    """The key is named, and nothing has started."""
    with pytest.raises(SatvibError) as caught:
        short(override)
    assert BAD[override] in str(caught.value)
    assert '\n' not in str(caught.value)


def test_wrong_gains_and_rigs_without_geometry_are_refused():
    """Gains of the wrong number or name, and a law for single struts."""
    for gains, told in (
        ('{gains_p: [1, 2]}', 'centralized: gains_p: 2 values for 3 struts'),
        ('{gains_q: [1, 2, 3]}', 'did you mean gains_p'),
        ('{law: narrowband}', "'narrowband' is not one of centralized"),
    ):
        with pytest.raises(SatvibError, match=told):
            short('scheme=centralized', f'centralized={gains}')
    with pytest.raises(SatvibError, match='set scheme: centralized in the scenario'):
        simulate(short('controller.law=centralized'))
