# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's experiments with laws that cancel, through the live graph: its figures beaten, every sample the twin's.

Bars: the paper's attenuations, -23.35, -26.00 and -29.28 dB (3-DOF) and -16.3 and -20.1 dB (1-DOF), at the tone as
measured by the loop's own samples on the paper's rigs, and in fine-grid truth (tone and RMS) on the clean ones. RMS as
measured ends at the sensors' noise, -22.8 dB at 1 m/s^2, on paper_3dof; it must come within 1.5 dB of that.
"""

import numpy as np
import pytest

# scenario: kinds that must beat the paper's figures, and further bars by kind in dB
BARS = {
    'paper_1dof_10hz_narrowband': (('measured_tone', 'measured_rms', 'true_tone'), {}),
    'paper_1dof_20hz_narrowband': (('measured_tone', 'measured_rms', 'true_tone'), {}),
    'paper_3dof_narrowband': (('measured_tone',), {}),
    'paper_3dof_feedforward': (('measured_tone',), {}),
    'clean_1dof_10hz': (('true_tone', 'true_rms'), {'true_tone': -50.0, 'true_rms': -35.0}),
    'clean_1dof_20hz': (('true_tone', 'true_rms'), {'true_tone': -50.0, 'true_rms': -35.0}),
    'clean_3dof_narrowband': (('true_tone', 'true_rms'), {'true_tone': -50.0, 'true_rms': -35.0}),
    'clean_3dof_feedforward': (('true_tone', 'true_rms'), {'true_tone': -50.0, 'true_rms': -35.0}),
}
SHORT = (
    'duration=12.0', 'phases.3.start=6.5', 'analysis.uncontrolled=[5.5, 6.5]',
    'analysis.controlled=[9.0, 12.0]',
)  # fmt: skip
# What the run and its twin must share bit for bit
FIELDS = {
    'acceleration': ('upper', 'lower'),
    'voltage': ('voltage', 'saturated', 'fault'),
    'model': ('a', 'b', 'covariance', 'updates'),
    'state': ('reference', 'error', 'output', 'voltage', 'weight_norm', 'frequency', 'adapting'),
    'truth': ('upper', 'lower'),
}


def check(name, folder, new_domain, *changes):
    """Run a scenario live, hold it against its twin and its bars."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.analysis.analysis import analyse
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    scenario = load_scenario(name, list(changes))
    with new_domain(folder):
        outcome = run_experiment(scenario, folder / 'run', composition='single')
    assert outcome.success, outcome.message
    run, twin = read_recording(outcome.bag), simulate(scenario)
    assert len(run.sequence) == len(twin.sequence)
    for group, fields in FIELDS.items():
        there = run.get(group, 'present')
        for field in fields:
            live, alone = run.get(group, field)[there], twin.get(group, field)[there]
            assert np.array_equal(live, alone, equal_nan=live.dtype.kind == 'f'), (group, field)
    found, _ = analyse(run)
    kinds, bars = BARS[name]
    reference = np.array(scenario.analysis.reference)
    for kind in kinds:
        assert np.all(found.attenuation[kind] < reference), (kind, found.attenuation[kind])
    for kind, bar in bars.items():
        assert np.all(found.attenuation[kind] < bar), (kind, found.attenuation[kind])
    floor = found.floor['measured_rms']
    if name.startswith('paper_3dof'):
        assert np.all(found.attenuation['measured_rms'] < floor + 1.5)
    assert {str(text) for text in run.get('state', 'reason')[-1]} == {''}


def test_the_papers_rig_with_a_tone_canceller(tmp_path, new_domain):
    """Truth: the bars above and the offline twin; a shortened run, seed 1."""
    check('paper_3dof_narrowband', tmp_path, new_domain, *SHORT)


def test_the_clean_rig_in_truth(tmp_path, new_domain):
    """Truth: the bars above and the offline twin; a shortened run, seed 2."""
    check('clean_3dof_feedforward', tmp_path, new_domain, *SHORT, 'seed=2')


@pytest.mark.long
@pytest.mark.parametrize('seed', [1, 2, 3])
@pytest.mark.parametrize('name', BARS)
def test_every_scenario_and_three_seeds(name, seed, tmp_path, new_domain):
    """Truth: the bars above and the offline twin; whole runs."""
    check(name, tmp_path, new_domain, f'seed={seed}')
