# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Runs satvib's own graph once and gives its figures."""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import yaml

from satvib_bringup.live.bench.case import Case, Figures
from satvib_bringup.live.workspace import graph_environment

_MODULE = 'satvib_bringup.live.bench.satvib_process'
_PATIENCE = 240.0  # s, besides the length of the run
_WARM = 0.5  # s that do not count
# the model that the paper prints, for more struts than a mechanical rig has
_MODEL = {'delay': 1, 'a': [-0.46, 0.158], 'b': [0.061, -0.103, 0.033]}


def run_satvib(case: Case, composition: str, folder: Path) -> Figures:
    """Run satvib's graph of a case.

    Args:
        case: what is measured.
        composition: separate, strut or single.
        folder: for the run and results; it is made.
    """
    folder.mkdir(parents=True)
    result, arrivals = folder / 'result.json', folder / 'arrivals.npz'
    plan = {
        'scenario': 'soft_3dof', 'settings': settings(case, folder), 'realtime': case.realtime,
        'composition': composition, 'folder': str(folder / 'run'), 'arrivals': str(arrivals),
        'result': str(result),
    }  # fmt: skip
    began = time.time()
    with (folder / 'log').open('wb') as log:
        try:
            subprocess.run(
                [sys.executable, '-m', _MODULE, json.dumps(plan)],
                env=graph_environment(), stdout=log, stderr=subprocess.STDOUT, check=False,
                timeout=case.seconds + _PATIENCE,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return Figures(failed='the run did not end')
    if not result.exists():
        last = (folder / 'log').read_text(errors='replace').strip().splitlines()
        return Figures(failed=last[-1] if last else 'the run failed')
    found = json.loads(result.read_text(encoding='utf-8'))
    if 'failed' in found:
        return Figures(failed=found['failed'])
    figures = Figures(
        samples_per_s=found['samples_per_s'],
        cpu=sum(found['cpu_of'].values()),
        cpu_of=found['cpu_of'],
        start=found['first_sample'] - began,
        memory=found['memory'],
        memory_all=found['memory_all'],
    )
    if case.realtime:
        noted = np.load(arrivals)
        figures.late_samples = int(noted['late_samples'])
        first = round(_WARM * case.rate)
        figures.take_arrivals(noted['voltages'], case.struts, case.rate, first, found['samples'])
    return figures


def settings(case: Case, folder: Path) -> list[str]:
    """Changes to soft_3dof: number of struts, rate, length; identification, a pause, and control all the time after."""
    found = [
        f'duration={case.seconds}',
        ('phases=[{phase: CALIBRATE}, {phase: IDENTIFY, start: 0.5}, {phase: STANDBY, start: 2.0}, '
        '{phase: CONTROL, start: 3.5}]'),
        'disturbance.start=2.0', 'analysis={}',
    ]  # fmt: skip
    if case.struts in {1, 3}:
        rate = f'rig.acquisition.sample_rate={case.rate}'
        count = [] if case.struts == 3 else ['rig.struts.count=1', 'rig.payload.mass=3.0']
        return [*found, rate, *count]
    rig = folder / 'models.yaml'
    data = {
        'plant': 'iir',
        'acquisition': {'sample_rate': case.rate},
        'models': [_MODEL] * case.struts,
    }
    rig.write_text(yaml.safe_dump(data), encoding='utf-8')
    return [*found, f'rig={rig}']
