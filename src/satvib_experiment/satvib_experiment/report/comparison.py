# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's experiment beside others: which law reaches what, on which acquisition, measured and in truth."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from satvib_common.arrays import Array
from satvib_common.process.parallel import cores, run_in_processes
from satvib_plant_sim.rig.rig import Acquisition

from satvib_experiment.analysis.evaluation import Evaluation, evaluate
from satvib_experiment.scenario.scenario import Scenario, load_scenario
from satvib_experiment.twin.closed_loop import simulate

# beside `paper_3dof`: the laws of this project, and an acquisition built for the job
BESIDE = (
    'paper_3dof_narrowband',
    'paper_3dof_feedforward',
    'clean_3dof',
    'clean_3dof_narrowband',
    'clean_3dof_feedforward',
)
HOLDS = {'zero': 'steps', 'linear': 'straight lines'}
OF_THE_PAPER = 'model_reference'
KINDS = ('measured_tone', 'true_tone', 'true_rms')
WHY = (
    'The paper’s law adds damping, which these stiff struts have already, so its modulus margin ends at about -4 dB; '
    'a law that cancels the tone ends at the steps that the output makes between the samples, and those go away '
    'with an acquisition built for the job.'
)


class Row(NamedTuple):
    """One run of a comparison.

    Attributes:
        scenario: its name.
        rate: Hz, of the samples.
        hold: how the output goes on between samples, `zero` or `linear`.
        law: of the controllers.
        attenuation: dB, the worst strut, by `KINDS`; None where it is not known.
        paper: dB, least and largest of what the paper reports; None when the scenario names no figures.
    """

    scenario: str
    rate: float
    hold: str
    law: str
    attenuation: dict[str, float | None]
    paper: tuple[float, float] | None


def row_of(scenario: Scenario, evaluation: Evaluation) -> Row:
    """Give the row of a run."""
    acquisition = scenario.load_rig().acquisition
    told = evaluation.reference
    return Row(
        scenario=scenario.name,
        rate=acquisition.sample_rate,
        hold=acquisition.hold if isinstance(acquisition, Acquisition) else 'zero',
        law=scenario.controller_parameters(acquisition.sample_rate).law,
        attenuation={kind: _worst(evaluation.attenuation[kind]) for kind in KINDS},
        paper=(max(told), min(told)) if len(told) else None,
    )


def _worst(values: Array) -> float | None:
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else None


def simulated_row(name: str, settings: Sequence[str] = ()) -> Row:
    """Run a scenario with the twin, and give its row.

    Args:
        name: of the scenario.
        settings: that change it, as `key=value`.
    """
    scenario = load_scenario(name, list(settings))
    return row_of(scenario, evaluate(simulate(scenario), None))


def simulated_rows(names: Sequence[str] = BESIDE, settings: Sequence[str] = ()) -> list[Row]:
    """Run scenarios with the twin, in a process for each core; the rows are in the order of the names.

    Raises:
        SatvibError: no such scenario, or one whose process dies each time.
    """
    # also one alone: this process may have threads of the middleware
    rows = dict(
        run_in_processes(
            simulated_row,
            lambda i: (names[i], settings),
            range(len(names)),
            cores(),
            called=lambda i: f'scenario {names[i]}',
        )
    )
    return [rows[i] for i in range(len(names))]


def plain(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Give rows as plain data, for result.json."""
    return [row._asdict() for row in rows]
