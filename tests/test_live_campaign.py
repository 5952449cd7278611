# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The worst trial of a campaign, run again as a live graph by the very settings that its report prints."""

import shlex

import numpy as np


def test_the_worst_trial_runs_again_as_a_live_graph(tmp_path, new_domain):
    """Truth: the fingerprint of all voltages that the campaign's batch left in its table; equal in every bit."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_studies.campaign.measures.metrics_kernel import fingerprint
    from satvib_studies.campaign.report.page import summarize
    from satvib_studies.campaign.run import begin, go_on
    from satvib_studies.campaign.settings import Campaign

    campaign = Campaign(
        name='live', scenario='quick_3dof', trials=12,
        parameters={
            'rig.payload.mass': {'kind': 'uniform', 'low': 7.0, 'high': 11.0},
            'disturbance.frequency': {'kind': 'uniform', 'low': 7.0, 'high': 14.0},
        },
    )  # fmt: skip
    plan, table = go_on(begin(campaign, tmp_path / 'c'), workers=0)
    worst = summarize(plan, table)['worst'][0]
    words = shlex.split(worst['command'])
    scenario = load_scenario(words[2], [word for word in words[3:] if word != '--set'])
    with new_domain(tmp_path):
        outcome = run_experiment(scenario, tmp_path / 'run', composition='single')
    assert outcome.success, outcome.message
    voltage = np.ascontiguousarray(read_recording(outcome.bag).get('voltage', 'voltage'))
    found = np.uint64(14695981039346656037)
    for row in voltage:
        found = fingerprint(row.view(np.uint64), found)
    assert int(found) == table['fingerprint'][worst['trial']].as_py()
