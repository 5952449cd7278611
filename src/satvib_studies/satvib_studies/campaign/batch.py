# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Runs trials as batches: what a worker does with one part of a campaign.

Trials whose scenarios can run in step (same phases, identifier, controller, sample rate, struts) make one batch; their
neither their order nor the other trials of a batch change a bit of them. A trial that cannot run leaves a row with the
reason.
"""

from __future__ import annotations

import json
from collections import defaultdict
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.errors import SatvibError
from satvib_experiment.scenario.centralized_scheme import geometry_of
from satvib_experiment.scenario.scenario import Scenario
from satvib_experiment.twin.closed_loop import BATCH_SHARES, ClosedLoop
from satvib_plant_sim.rig.any_rig import AnyRig, strut_count
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.campaign.measures.metrics import TrialMetrics
from satvib_studies.campaign.trials import TrialPlan

Columns = dict[str, NDArray[Any]]

# trials that are in step: their arrays together should stay within a core's own cache
BATCH = 512


def in_step(scenario: Scenario, rig: AnyRig) -> str:
    """Give what trials of one batch have in common, as text."""
    steps, places = (1, 0), {}
    if isinstance(rig, Rig):
        steps = (rig.acquisition.fine_steps, rig.acquisition.filter_order)
        # one controller for all struts knows where they stand
        places = geometry_of(rig, scenario.name) if scenario.scheme == 'centralized' else {}
    phases = [(s.phase, s.start) for s in scenario.phases]
    shared = [
        [getattr(scenario, name) for name in BATCH_SHARES if name != 'phases'], phases,
        type(rig).__name__, rig.acquisition.sample_rate, steps, places,
        strut_count(rig), isinstance(rig, Rig) and len(rig.struts.each),
    ]  # fmt: skip
    return json.dumps(shared, sort_keys=True)


def run_loop(loop: ClosedLoop) -> Columns:
    """Run a loop to its end and give its trials' figures."""
    metrics = TrialMetrics(loop)
    for step in loop.steps():
        metrics.add(step)
    return metrics.columns()


def run_scenarios(scenarios: list[Scenario | str], batch: int = BATCH) -> Columns:
    """Run scenarios, and give their figures in their order.

    Args:
        scenarios: each a scenario, or the text why there is none.
        batch: the most trials that run in step.
    """
    errors = np.array([s if isinstance(s, str) else '' for s in scenarios], dtype=object)
    groups: dict[str, list[tuple[int, Scenario, AnyRig]]] = defaultdict(list)
    for i, scenario in enumerate(scenarios):
        if isinstance(scenario, str):
            continue
        try:
            rig = scenario.load_rig()
            groups[in_step(scenario, rig)].append((i, scenario, rig))
        except SatvibError as error:
            errors[i] = str(error)
    found: list[tuple[NDArray[np.intp], Columns]] = []
    for members in groups.values():
        for first in range(0, len(members), batch):
            found += _run(members[first : first + batch], errors)
    return _joined(found, len(scenarios), errors)


def _run(
    members: list[tuple[int, Scenario, AnyRig]], errors: NDArray[Any]
) -> list[tuple[NDArray[np.intp], Columns]]:
    """Run one batch; when it cannot run, its trials one by one, to find which."""
    rows = np.array([i for i, _, _ in members], dtype=np.intp)
    try:
        loop = ClosedLoop([s for _, s, _ in members], [r for _, _, r in members])
        return [(rows, run_loop(loop))]
    except SatvibError as error:
        if len(members) == 1:
            errors[rows[0]] = str(error)
            return []
    return [pair for member in members for pair in _run([member], errors)]


def _joined(
    found: list[tuple[NDArray[np.intp], Columns]], count: int, errors: NDArray[Any]
) -> Columns:
    table: Columns = {}
    for rows, columns in found:
        for name, values in columns.items():
            if name not in table:
                table[name] = _blank(values.dtype, count)
            table[name][rows] = values
    return table | {'error': errors}


def _blank(dtype: np.dtype[Any], count: int) -> NDArray[Any]:
    if dtype.kind == 'f':
        return np.full(count, np.nan)
    return np.full(count, '', dtype=object) if dtype.kind == 'O' else np.zeros(count, dtype=dtype)


def run_part(plan: TrialPlan) -> Columns:
    """Run every trial of a (part of a) plan; what depends on nothing but the plan."""
    scenarios: list[Scenario | str] = []
    for i in range(len(plan.seeds)):
        try:
            scenarios.append(plan.scenario(i))
        except SatvibError as error:
            scenarios.append(str(error))
    return run_scenarios(scenarios)
