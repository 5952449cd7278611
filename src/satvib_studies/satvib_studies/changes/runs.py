# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Runs drawn changes as batches of the twin, three times: controlled, open loop, and begun anew on the changed rig.

The promise is judged in the truth: the power of the fine grid over windows of half a second, controlled over open loop,
of the same rig, seed and changes. A strut is loud in a window above +6 dB.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_experiment.scenario.scenario import Scenario, load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop
from satvib_plant_sim.rig.rig import load_rig

from satvib_studies.benchmark import robustness
from satvib_studies.changes.drawing import DISTURBANCE_KINDS, KINDS, Change, draw_change

CONTROL = 6.5  # s
END = 33.0  # s
WINDOW = 0.5  # s
LOUD = 6.0  # dB
SETTLED = 3.0  # s at the end, whose level is compared
RIGS = robustness.RIGS | {'paper_1dof': robustness.RIGS['paper_3dof']}
SCENARIOS = {'paper_1dof': 'paper_1dof_10hz'}


@dataclass(frozen=True)
class Outcome:
    """What became of trials; arrays are (trials,) unless said.

    Attributes:
        changes: what happened.
        loud_time: s, the longest time that a strut was above +6 dB.
        loudest: dB, of any window and strut.
        end: (trials, struts) dB at the end.
        fresh: (trials, struts) dB of a run that begins on the changed rig; NaN where none was asked for.
        fault: (trials, struts) whether 0 V is latched at the end.
    """

    changes: list[Change]
    loud_time: Array
    loudest: Array
    end: Array
    fresh: Array
    fault: Mask


def scenario_of(
    rig: str, law: str, change: Change, seed: int, fresh: bool = False, more: Sequence[str] = ()
) -> Scenario:
    """The scenario of a trial.

    Args:
        rig, law, change, seed: of the trial.
        fresh: the rig, not the disturbance, has changed before the run begins.
        more: settings as key=value, over those of the trial.
    """
    failures = [dict(failure) for failure in change.failures]
    if fresh:
        for failure in failures:
            if failure['kind'] != 'disturbance_changed':
                failure['time'] = 0.0
    return load_scenario(
        SCENARIOS.get(rig, rig),
        [
            *RIGS[rig],
            robustness.PHASES,
            f'duration={END}',
            f'seed={seed}',
            f'controller.law={law}',
            f'disturbance={json.dumps(change.disturbance)}',
            f'failures={json.dumps(failures)}',
            f'analysis={{uncontrolled: [5.5, 6.5], controlled: [{END - SETTLED}, {END}]}}',
            *more,
        ],
    )


def run_changes(
    rig: str,
    law: str,
    trials: Sequence[int],
    kinds: tuple[str, ...] = KINDS,
    more: Sequence[str] = (),
    fresh: bool = True,
) -> Outcome:
    """Run the trials of one rig and law as one batch each.

    Args:
        rig: one of `RIGS`.
        law: as in a scenario.
        trials: numbers of the trials, which are their seeds too.
        kinds: of changes to draw from.
        more: settings as key=value, over those of the trials.
        fresh: whether the third runs are made, which begin on the changed rig.
    """
    nominal = load_rig(rig)
    changes = [draw_change(nominal, trial, kinds) for trial in trials]

    def powers(law: str, anew: bool) -> tuple[Array, Mask]:
        return _powers(
            [
                scenario_of(rig, law, change, trial, anew, more)
                for change, trial in zip(changes, trials, strict=True)
            ]
        )

    controlled, fault = powers(law, False)
    still, _ = powers('off', False)
    begun = controlled if fresh else np.full_like(controlled, np.nan)
    if fresh and any(change.kind not in DISTURBANCE_KINDS for change in changes):
        begun, _ = powers(law, True)
    first, last = round(CONTROL / WINDOW), round(SETTLED / WINDOW)
    gain = 10.0 * np.log10(controlled[first:] / still[first:])
    end = 10.0 * np.log10(controlled[-last:].mean(axis=0) / still[-last:].mean(axis=0))
    from_new = 10.0 * np.log10(begun[-last:].mean(axis=0) / still[-last:].mean(axis=0))
    loud_time = _longest(gain > LOUD).max(axis=-1) * WINDOW
    return Outcome(changes, loud_time, gain.max(axis=(0, -1)), end, from_new, fault)


def count_stops(rig: str, law: str, trials: Sequence[int], more: Sequence[str] = ()) -> Mask:
    """Run disturbances that change on a rig that does not; give which struts (trials, struts) end at 0 V, latched.

    Every one of them is a false stop.
    """
    nominal = load_rig(rig)
    scenarios = [
        scenario_of(rig, law, draw_change(nominal, trial, DISTURBANCE_KINDS), trial, False, more)
        for trial in trials
    ]
    for step in ClosedLoop(scenarios).steps():
        fault = step.output.fault
    return np.array(fault)


def _powers(scenarios: list[Scenario]) -> tuple[Array, Mask]:
    """Power of the payload (windows, trials, struts), (m/s^2)^2, and which struts end in a fault."""
    loop = ClosedLoop(scenarios)
    count = round(WINDOW / loop.plant.dt)
    windows = []
    total = np.zeros((len(scenarios), loop.plant.struts))
    fault = np.zeros(total.shape, dtype=bool)
    for step in loop.steps():
        total += (step.truth.upper**2).mean(axis=-1) / count
        fault = step.output.fault
        if (step.sequence + 1) % count == 0:
            windows.append(total)
            total = np.zeros_like(total)
    return np.array(windows), np.array(fault)


def _longest(loud: Mask) -> Array:
    """Length of the longest run of True along the first axis."""
    longest = now = np.zeros(loud.shape[1:])
    for row in loud:
        now = np.where(row, now + 1.0, 0.0)
        longest = np.maximum(longest, now)
    return longest
