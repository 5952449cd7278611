# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the bare graph once, in processes as satvib has them, and gives its figures."""

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.struts.names import strut_names

from satvib_bringup.live.bench.case import Case, Figures
from satvib_bringup.live.supervisor import Supervisor
from satvib_bringup.live.workspace import graph_environment

_MODULE = 'satvib_bringup.live.bench.floor_process'
_PATIENCE = 90.0  # s, besides the length of the run
_WARM = 0.5  # s that do not count
_LOCKSTEP = 5.0  # s


def run_floor(case: Case, composition: str, folder: Path) -> Figures:
    """Run the bare graph of a case.

    Args:
        case: what is measured.
        composition: separate or strut.
        folder: for logs and results; it is made.
    """
    struts = list(strut_names(case.struts))
    together = [['controller', 'identifier']]
    groups = together if composition == 'strut' else [[role] for role in together[0]]
    plans: list[dict[str, Any]] = [
        {'roles': roles, 'struts': [strut]} for roles in groups for strut in struts
    ]
    plans.append({'roles': ['recorder'], 'struts': struts})
    result = folder / 'floor.json'
    began = time.time()
    with Supervisor(folder, graph_environment()) as supervisor:
        pids = {}
        for plan in plans:
            name = (
                f'{"+".join(plan["roles"])} {plan["struts"][0] if len(plan["struts"]) == 1 else ""}'
            )
            pids[name.strip()] = supervisor.start(name.strip().replace(' ', '.'), _command(plan))
        seconds = case.seconds if case.realtime else _LOCKSTEP
        source = {
            'roles': ['source'], 'struts': struts, 'rate': case.rate, 'seconds': seconds,
            'realtime': case.realtime, 'readers': 3, 'pids': pids, 'result': str(result),
        }  # fmt: skip
        supervisor.start('source', _command(source))
        deadline = time.monotonic() + case.seconds + _PATIENCE
        while supervisor.is_running('source'):
            if time.monotonic() > deadline:
                return Figures(failed='the bare graph did not end')
            time.sleep(0.1)
        supervisor.stop(list(supervisor.pids()), 0.2)
    if not result.exists():
        return Figures(failed='the source of the bare graph failed')
    return _figures(case, json.loads(result.read_text(encoding='utf-8')), result, began)


def _command(plan: dict[str, Any]) -> list[str]:
    return [sys.executable, '-m', _MODULE, json.dumps(plan)]


def _figures(case: Case, found: dict[str, Any], result: Path, began: float) -> Figures:
    figures = Figures(
        samples_per_s=found['samples_per_s'],
        cpu=sum(found['cpu_of'].values()),
        cpu_of=found['cpu_of'],
        late_samples=found['late_samples'] if case.realtime else None,
        start=found['first_sample'] - began,
        memory=found['memory'],
        memory_all=found['memory_all'],
    )
    if case.realtime:
        arrivals = np.load(result.with_suffix('.npy'))
        first = round(_WARM * case.rate)
        figures.take_arrivals(arrivals, case.struts, case.rate, first, found['samples'])
    return figures
