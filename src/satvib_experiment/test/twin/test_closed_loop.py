# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The offline twin: the same seed the same bits, alone or in a batch."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_experiment.recording.recording import differences
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate, simulate_batch, simulate_open_loop


def test_one_seed_gives_the_same_bits_and_another_does_not(quick, quick_run):
    """Truth: the run itself; no tolerance."""
    assert differences(quick_run, simulate(quick)) == []
    other = differences(quick_run, simulate(quick.replace(seed=2)))
    assert any(line.startswith('acceleration.upper') for line in other)
    assert any(line.startswith('voltage.voltage') for line in other)


def test_a_batch_is_bit_for_bit_its_single_runs(quick, quick_run):
    """Trials that differ in seed, rig and disturbance. Truth: each of them run alone; no tolerance."""
    variations = [
        quick,
        load_scenario('quick_3dof', ['seed=5', 'rig.payload.mass=11.5']),
        load_scenario(
            'quick_3dof', ['seed=6', 'disturbance.frequency=17', 'rig.coil.resistance=3']
        ),
    ]
    batch = simulate_batch(variations)
    assert differences(batch[0], quick_run) == []
    for one, scenario in zip(batch[1:], variations[1:], strict=True):
        assert differences(one, simulate(scenario)) == []


def test_a_batch_without_truth_has_the_same_loop(quick, quick_run):
    """Truth: the full recording."""
    bare = simulate_batch([quick], truth=False)[0]
    assert not bare.has('truth')
    assert differences(bare, quick_run) == ['truth: only one of them has it']


def test_scenarios_that_do_not_run_in_step_are_refused(quick):
    """Truth: the rule that a batch shares everything but rig, disturbance and seed."""
    with pytest.raises(SatvibError, match='differ in controller'):
        simulate_batch([quick, load_scenario('quick_3dof', ['controller.law=off'])])
    with pytest.raises(SatvibError, match='sample rate'):
        simulate_batch([quick, load_scenario('quick_3dof', ['rig.acquisition.sample_rate=200'])])


def test_the_open_loop_twin_is_the_run_until_a_voltage_moves_it(quick_run):
    """Up to the first voltage the twin and the run are one; later they part. Truth: the run, no tolerance."""
    twin = simulate_open_loop(quick_run)
    first = int(np.argmax(np.any(quick_run.get('voltage', 'voltage') != 0.0, axis=1)))
    assert first > 0
    for group in ('acceleration', 'truth'):
        one, other = quick_run.get(group, 'upper'), twin.get(group, 'upper')
        np.testing.assert_array_equal(one[:first], other[:first])
        assert np.any(one[first + 1 :] != other[first + 1 :])


def test_the_law_off_is_the_open_loop_twin_after_identification():
    """With the law off and no excitation nothing moves the plate but the disturbance. Truth: the twin, bit for bit."""
    scenario = load_scenario(
        'quick_3dof', ['controller.law=off', 'controller.excitation_amplitude=0']
    )
    run = simulate(scenario)
    assert np.all(run.get('voltage', 'voltage') == 0.0)
    twin = simulate_open_loop(run)
    np.testing.assert_array_equal(run.get('truth', 'upper'), twin.get('truth', 'upper'))


def test_the_model_changes_hands_at_stated_samples_only(quick_run, quick):
    """What the law knows of the model changes at no other sample than a hand-over. Truth: the phase plan."""
    bound = quick_run.get('state', 'ki_max')
    changed = np.flatnonzero(np.any(np.diff(np.nan_to_num(bound), axis=0) != 0.0, axis=1)) + 1
    assert len(changed) > 0
    assert all(quick_run.plan.is_hand_over(int(k), quick.model_period) for k in changed)
