# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Every benchmark that a page names is started by a test in a short form.

Truth: the pages; the exit code of the script, and that it says something. What it says is not judged: the figures of a
page come from the long form.
"""

import os
import re
import subprocess
import sys

import pytest
from source_tree import ROOT

# by benchmark: the arguments of its short form
SHORT = {
    'active_suspension': ['--short', '--segments', '1', '--random', '1'],
    'active_suspension_figures': [],
    'between_samples': ['--only', 'serving'],
    'campaign_speed': ['quick_3dof', '--batches', '1', '4'],
    'changes': ['--trials', '1', '--rigs', 'soft_3dof', '--laws', 'velocity_feedback'],
    'changes_live': ['--run', 'paper_1dof:velocity_feedback:1'],
    'control_laws': [],
    'daq_kill': ['--times', '1', '--only', 'guardian'],
    'daq_scenario': ['quick_3dof'],
    'faults': ['--rounds', '1', '--only', 'one in twenty'],
    'feedforward': [],
    'fuzz_bags': ['--files', '3'],
    'fuzz_records': ['--files', '20'],
    'fuzz_yaml': ['--files', '20'],
    'hexapod': ['--figure', 'figure.png'],
    'identification_cost': ['--streams', '10', '--updates', '10', '--rounds', '1'],
    'identification_tables': ['trust', '--trials', '1'],
    'identify_speed': ['--samples', '20000'],
    'machines': ['--only', 'static peers'],
    'model_phase': ['--seeds', '1'],
    'particle_swarm': ['--seeds', '1', '--budget', '48', '--plants', '1', '--only', 'sphere'],
    'robustness': [
        '--trials', '2', '--rigs', 'clean_3dof', '--laws', 'velocity_feedback', '--cases', 'own',
    ],
    'several_tones': ['--seeds', '1', '--laws', 'feedforward', '--tones', '0'],
    'soak': ['--minutes', '0.3', '--kind', 'lockstep', '--no-page'],
    'velocity_drift': [],
    'watch_load': ['--seconds', '40'],
    'wrong_model': [],
}  # fmt: skip
# modules of benchmarks/ that are no script
PARTS = {'fuzzing'}


def test_every_benchmark_has_a_short_form():
    """Truth: the folder and the pages."""
    scripts = {path.stem for path in (ROOT / 'benchmarks').glob('*.py')}
    assert scripts - PARTS == set(SHORT)
    pages = [*ROOT.glob('*.md'), *(ROOT / 'docs').rglob('*.md')]
    named = {
        name for page in pages for name in re.findall(r'benchmarks/(\w+)\.py', page.read_text())
    }
    assert len(named) > 15
    assert named <= scripts


@pytest.mark.long
@pytest.mark.timeout(600)
@pytest.mark.usefixtures('domain')
@pytest.mark.parametrize('name', SHORT)
def test_the_short_form_runs(name, tmp_path):
    command = [sys.executable, str(ROOT / 'benchmarks' / f'{name}.py'), *SHORT[name]]
    environment = os.environ | {'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=590, check=False
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stdout.strip()
