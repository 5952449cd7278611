# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Trials of a campaign: the scenarios they stand for, their figures, and their bits in any company."""

import shlex

import numpy as np
import pytest
import yaml
from satvib_common.errors import SatvibError
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.recording.recording import differences
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop, simulate, simulate_batch
from satvib_studies.campaign.batch import run_loop, run_part, run_scenarios
from satvib_studies.campaign.measures.metrics_kernel import (
    add_sample,
    fingerprint,
    rms_level,
    tone_level,
)
from satvib_studies.campaign.settings import Campaign, campaign_names, load_campaign
from satvib_studies.campaign.trials import plan_trials

PARAMETERS = {
    'rig.payload.mass': {'kind': 'uniform', 'low': 7.0, 'high': 11.0},
    'rig.struts.stiffness_scale.1': {'kind': 'normal', 'mean': 1.0, 'deviation': 0.03},
    'controller.law': {'kind': 'choice', 'values': ['model_reference', 'velocity_feedback']},
    'disturbance.frequency': {'kind': 'lognormal', 'median': 10.0, 'spread': 0.2},
}


def plan_of(trials, scenario='quick_3dof', **changes):
    told = {'name': 'c', 'scenario': scenario, 'trials': trials, 'parameters': PARAMETERS}
    return plan_trials(Campaign(**told | changes))


def rows_that_differ(columns, single, row):
    """Columns of one row whose bits are not those of a single run."""
    different = []
    for name, values in single.items():
        a, b = np.asarray(values[:1]), np.asarray(columns[name][row : row + 1])
        same = a.tobytes() == b.tobytes() if a.dtype.kind != 'O' else list(a) == list(b)
        if not same:
            different.append(name)
    return different


def check_singles(plan, count):
    columns = run_part(plan)
    chosen = np.random.default_rng(7).choice(len(plan.seeds), count, replace=False)
    for row in chosen:
        loop = ClosedLoop(plan.scenario(int(row)))
        assert loop.shape == ()
        assert rows_that_differ(columns, run_loop(loop), row) == []
    assert len(set(columns['fingerprint'].tolist())) == len(plan.seeds)


def test_20_random_trials_have_the_bits_of_their_single_runs():
    """Truth: the offline run of one scenario alone, shape (); equal in every bit of every figure, voltages included.

    The fingerprint covers all bits of all voltages of all samples; no two trials share one.
    """
    check_singles(plan_of(40), 20)


def test_hexapods_have_the_bits_of_their_single_runs():
    """Truth: the offline run of one scenario alone; equal in every bit of every figure, six struts, six directions."""
    parameters = {
        'rig.payload.mass': {'kind': 'uniform', 'low': 12.6, 'high': 23.4},
        'rig.payload.center_of_gravity.2': {'kind': 'uniform', 'low': -0.02, 'high': 0.06},
        'disturbance.terms.0.frequency': {'kind': 'uniform', 'low': 5.0, 'high': 12.0},
    }
    phases = [('CALIBRATE', 0.0), ('IDENTIFY', 0.3), ('STANDBY', 1.3), ('CONTROL', 1.8)]
    short = {
        'duration': 2.5, 'phases': [{'phase': p, 'start': s} for p, s in phases],
        'analysis': {}, 'disturbance.terms.0.start': 1.3,
    }  # fmt: skip
    check_singles(plan_of(6, 'hexapod_6dof', parameters=parameters, set=short), 3)


def test_samples_that_only_some_trials_use_do_not_show_in_the_others():
    """Truth: the recording of one scenario alone; equal bits, with a floor that trials pass at other times."""
    settings = {'identifier.regressor_floor': 14.0, 'controller.excitation': 'chirp'}
    plan = plan_of(3, set=settings, parameters={'rig.payload.mass': PARAMETERS['rig.payload.mass']})
    scenarios = [plan.scenario(i) for i in range(3)]
    for scenario, among in zip(scenarios, simulate_batch(scenarios, truth=False), strict=True):
        alone = simulate(scenario)
        del alone.groups['truth']
        assert differences(alone, among) == []


@pytest.mark.long
def test_20_trials_of_the_paper_have_the_bits_of_their_single_runs():
    """Truth: as above, for 25 s of the paper's experiment."""
    parameters = {k: v for k, v in PARAMETERS.items() if k != 'controller.law'}
    check_singles(plan_of(96, 'paper_3dof', parameters=parameters), 20)


def test_figures_are_those_of_the_report():
    """Truth: `evaluate` on the whole recording, least squares by LAPACK; 1e-9 dB."""
    plan = plan_of(3)
    columns = run_part(plan)
    for row in range(3):
        recording = simulate(plan.scenario(row))
        wanted = evaluate(recording)
        for kind in ('true_rms', 'true_tone', 'measured_rms', 'measured_tone'):
            found = [columns[f'attenuation_{kind}_{i}'][row] for i in (1, 2, 3)]
            np.testing.assert_allclose(found, wanted.attenuation[kind], atol=1e-9)
            assert columns[f'attenuation_{kind}'][row] == max(found)
        found = [columns[f'voltage_peak_{i}'][row] for i in (1, 2, 3)]
        np.testing.assert_array_equal(found, wanted.largest_voltage)
        assert columns['saturated_share'][row] == pytest.approx(wanted.saturated_share.max())


def test_the_command_of_a_trial_makes_its_scenario():
    """Truth: the scenario that `run --set` loads from the printed words; equal in every field."""
    plan = plan_of(5, set={'model_period': 25})
    for trial in range(5):
        words = shlex.split(plan.command(trial))
        assert words[:2] == ['./satvib', 'run']
        settings = [word for word in words[3:] if word != '--set']
        assert load_scenario(words[2], settings) == plan.scenario(trial)


def test_paths_of_a_campaign_are_relative_to_its_file_and_those_of_the_command_line_to_the_current_folder(
    tmp_path, monkeypatch
):
    """Truth: the masses written into two rigs of one name; the printed command finds the same rig from anywhere."""
    there = tmp_path / 'there'
    there.mkdir()
    rig = load_scenario('paper_3dof').load_rig().to_mapping()
    for folder, mass in ((tmp_path, 7.0), (there, 8.0)):
        rig['payload']['mass'] = mass
        (folder / 'rig.yaml').write_text(yaml.safe_dump(rig))
    told = {'scenario': 'quick_3dof', 'trials': 2, 'set': {'rig': 'rig.yaml'}}
    told |= {'parameters': {'disturbance.amplitude': {'kind': 'uniform', 'low': 0.5, 'high': 1.0}}}
    (there / 'c.yaml').write_text(yaml.safe_dump(told))
    monkeypatch.chdir(tmp_path)
    for overrides, mass in (
        ([], 8.0),
        (['set.rig=rig.yaml'], 7.0),
        (['set={rig: rig.yaml}'], 7.0),
    ):
        plan = plan_trials(load_campaign('there/c.yaml', overrides))
        assert plan.base.load_rig().payload.mass == mass
        settings = [word for word in shlex.split(plan.command(0))[3:] if word != '--set']
        monkeypatch.chdir('/')
        assert load_scenario('quick_3dof', settings).load_rig().payload.mass == mass
        monkeypatch.chdir(tmp_path)


def test_level_of_a_known_signal():
    """Truth: a bias, a sine and a cosine of known amplitudes over whole periods; 1e-12 relative."""
    dt, steps, samples = 0.01, 4, 200
    t = np.arange(samples * steps) * dt / steps
    signal = 2.0 + 0.3 * np.cos(2 * np.pi * 5.0 * t) + 0.4 * np.sin(2 * np.pi * 12.0 * t)
    windows, tones = np.array([[50.0, 150.0]]), np.array([5.0, 12.0, np.nan])
    origin = np.full((2, 1), np.nan)
    sums, gram = np.zeros((1, 2, 1, 8)), np.zeros((1, 2, 7, 7))
    for k in range(samples):
        fine = signal[k * steps : (k + 1) * steps][None]
        add_sample(float(k), dt, windows, tones, fine, fine[:, 0], origin, sums, gram)
    for source in (0, 1):
        level = tone_level(tones, sums[0, source], gram[0, source])
        assert level == pytest.approx([0.5], rel=1e-12)
        rms = rms_level(tones, sums[0, source], gram[0, source])
        assert rms == pytest.approx([0.5 / np.sqrt(2.0)], rel=1e-12)


def test_a_fingerprint_sees_a_single_bit():
    """Truth: two rows that differ in the last bit of one number, and in their order; all three differ."""
    start = np.uint64(1)
    rows = [[1.0, 2.0], [1.0, np.nextafter(2.0, 3.0)], [2.0, 1.0]]
    assert len({int(fingerprint(np.array(row).view(np.uint64), start)) for row in rows}) == 3


def test_a_trial_that_cannot_run_leaves_the_others_alone():
    """Truth: the same trials without it; equal bits, and the row says why."""
    plan = plan_of(3)
    good = [plan.scenario(i) for i in range(3)]
    broken = good[1].replace(rig_overrides={'payload.mass': -1.0})
    alone = run_scenarios([good[0], good[2]])
    among = run_scenarios([good[0], broken, 'no scenario', good[2]])
    assert 'payload.mass' in among['error'][1]
    assert list(among['error'][[0, 2, 3]]) == ['', 'no scenario', '']
    assert np.isnan(among['attenuation_true_rms'][1])
    assert list(among['fingerprint'][[0, 3]]) == list(alone['fingerprint'])


@pytest.mark.parametrize(
    ('parameters', 'told'),
    [
        ({'rig.payload.weight': PARAMETERS['rig.payload.mass']}, 'rig.payload.weight.*no such key'),
        ({'controller.gane': PARAMETERS['rig.payload.mass']}, 'controller.gane.*no such key'),
        ({'nonsense': PARAMETERS['rig.payload.mass']}, 'nonsense.*no such key'),
        ({'rig.payload.mass': {'kind': 'uniform', 'low': -3.0, 'high': 3.0}}, 'not above 0'),
        ({'duration': {'kind': 'uniform', 'low': 3.0, 'high': 9.0}}, 'shared by all trials'),
        (
            {'rig.payload.mass': {'kind': 'uniform', 'low': 9.0, 'high': 3.0}},
            'nothing lies between',
        ),
    ],
)
def test_wrong_parameters_are_refused_before_anything_runs(parameters, told):
    """Truth: the page on campaigns; one line that names the parameter."""
    with pytest.raises(SatvibError, match=told) as caught:
        plan_of(8, parameters=parameters)
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize('name', campaign_names())
def test_campaigns_of_the_package_can_be_planned(name):
    """Truth: every file that is shipped loads, and both ends of all its parameters make a scenario."""
    campaign = load_campaign(name)
    assert len(plan_trials(campaign.replace(trials=8)).seeds) == 8
