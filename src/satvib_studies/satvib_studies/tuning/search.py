# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The search for the gains of the centralized law: settings, the search itself, the file of gains.

    found = tune(load_rig('soft_3dof'), disturbance, TuneSettings())
    write_gains(found, Path('gains.yaml'))

*Untuned* is the law with the paper's gain, 550 V/(g s) = 56.1 V/(m/s), as P of every mode, and nothing else: what one
sets without a search. It is a member of the first swarm, so the search cannot end worse.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml, parse_yaml
from satvib_common.levels import decibel
from satvib_common.schema import Schema, param
from satvib_experiment.scenario.memory import check_needs
from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.tuning.cost import CostSettings, TuningCost
from satvib_studies.tuning.loop_cost import LoopFigure
from satvib_studies.tuning.particle_swarm import ParticleSwarm, SwarmResult, SwarmSettings
from satvib_studies.tuning.swarm_checkpoint import restore

UNTUNED = 550.0 / 9.80665
NAMES = ('gains_p', 'gains_i', 'gains_d')


@dataclass(frozen=True, kw_only=True)
class TuneSettings(Schema):
    """Settings of a search."""

    cost: CostSettings = param(CostSettings(), 'what counts')
    swarm: SwarmSettings = param(SwarmSettings(), 'how it is looked for')


@dataclass(frozen=True)
class Tuned:
    """What a search found.

    Attributes:
        rig, disturbance: what it was for; the disturbance as plain data.
        settings: of the search.
        cost: what was minimized.
        result: of the swarm.
        untuned: (size,) gains to compare with.
    """

    rig: Rig
    disturbance: dict[str, Any]
    settings: TuneSettings
    cost: TuningCost
    result: SwarmResult
    untuned: Array

    def attenuation(self, gains: Array) -> Array:
        """RMS of all modes against 0 V, plant by plant (plants,), dB."""
        still = self.cost.figures(np.zeros((1, self.cost.size)))[0]
        moved = self.cost.figures(gains[None])[0]
        found: Array = decibel(self.cost.level(moved), self.cost.level(still))
        return found

    def centralized(self, gains: Array | None = None) -> dict[str, Any]:
        """Give gains, those that were found when none are named, as the `centralized` of a scenario."""
        rows = (self.result.position if gains is None else gains).reshape(3, -1)
        found: dict[str, Any] = {
            name: [float(f'{v:.6g}') for v in row] for name, row in zip(NAMES, rows, strict=True)
        }
        return found | {'velocity_corner': self.settings.cost.corner}


def read_disturbance(text: str) -> dict[str, Any]:
    """Give a disturbance as plain data, from YAML in one line, from a YAML file, or of a scenario by name.

    Raises:
        SatvibError: none of these.
    """
    from satvib_experiment.scenario.folder import scenario_names
    from satvib_experiment.scenario.scenario import load_scenario

    if text in scenario_names():
        return dict(load_scenario(text).disturbance)
    data: Any
    if text.endswith(('.yaml', '.yml')):
        data = load_yaml(Path(text))
        data = data.get('disturbance', data) if isinstance(data, dict) else data
    else:
        data = parse_yaml(text, '--disturbance')
    if not isinstance(data, dict):
        raise SatvibError(
            f'--disturbance {text}: a scenario, a YAML file or YAML is expected, as in '
            "'{kind: sine, frequency: 9, amplitude: 0.5}'"
        )
    return data


class SwarmSearch:
    """A search by a swarm that can be interrupted."""

    def swarm(self) -> ParticleSwarm:
        """Give the swarm as it begins."""
        raise NotImplementedError

    def check(self, checkpoint: Path) -> None:
        """Refuse a checkpoint that this search cannot go on from; one that is not there is none."""
        if checkpoint.exists():
            restore(self.swarm(), checkpoint)


@dataclass
class Search(SwarmSearch):
    """A search that is set up and can be run.

    Args:
        rig: a rig with a geometry.
        disturbance: plain data.
        settings: see `TuneSettings`.

    Raises:
        SatvibError: a rig of identified models, a wrong disturbance.
    """

    rig: Any
    disturbance: dict[str, Any]
    settings: TuneSettings = field(default_factory=TuneSettings)

    def __post_init__(self) -> None:
        """Set the cost up."""
        if not isinstance(self.rig, Rig):
            raise SatvibError(f'rig {self.rig.name}: identified models have no modes to control')
        swarm, plants = self.settings.swarm, self.settings.cost.plants
        check_needs(
            f'swarm.budget, cost.plants: {swarm.budget} evaluations on {plants} plants',
            seconds=1e-6 * swarm.budget * plants,
        )
        check_needs(
            f'swarm.particles, cost.plants: {swarm.particles} particles on {plants} plants',
            8.0 * (LoopFigure.MODES + 6) * swarm.particles * plants,
        )
        built: Disturbance = make_disturbance(self.disturbance, '--disturbance')
        self.cost = TuningCost(self.rig, built, self.settings.cost)
        untuned = np.zeros((3, len(self.cost.modes.names)))
        untuned[0] = UNTUNED
        self.untuned = np.clip(untuned.ravel(), self.cost.lower, self.cost.upper)

    def swarm(self) -> ParticleSwarm:
        """Give the swarm as it begins."""
        cost = self.cost
        return ParticleSwarm(cost.lower, cost.upper, self.settings.swarm, start=self.untuned)

    def run(
        self,
        progress: Callable[[ParticleSwarm], None] | None = None,
        checkpoint: Path | None = None,
    ) -> Tuned:
        """Search; see `ParticleSwarm.run`."""
        cost = self.cost
        result = self.swarm().run(cost, progress, checkpoint)
        return Tuned(self.rig, self.disturbance, self.settings, cost, result, self.untuned)


def summary_row(cost: TuningCost, figures: Array, total: float) -> dict[str, float]:
    """Give what is worth telling of figures (plants, 7): cost, dB, V, margin."""
    still = cost.figures(np.zeros((1, cost.size)))[0]
    decibels = decibel(cost.level(figures), cost.level(still))
    return {
        'cost': total,
        'attenuation': float(decibels[0]),
        'attenuation_worst_plant': float(decibels.max()),
        'voltage': float(figures[0, LoopFigure.VOLTS]),
        'margin': float(figures[0, LoopFigure.MARGIN]),
        'margin_worst_plant': float(figures[:, LoopFigure.MARGIN].min()),
    }


def summary(found: Tuned) -> dict[str, dict[str, float]]:
    """Give the figures of the gains found and of the untuned ones: cost, dB, V, margin."""
    cost = found.cost
    return {
        name: summary_row(cost, cost.figures(gains[None])[0], float(cost(gains[None])[0]))
        for name, gains in (('tuned', found.result.position), ('untuned', found.untuned))
    }


def write_gains(found: Tuned, path: Path) -> None:
    """Write what a scenario takes as `centralized: {file: ...}`, with where it comes from.

    Raises:
        SatvibError: the file is there already, or cannot be written.
    """
    data = {
        'centralized': found.centralized(),
        'tuned_for': {'rig': found.rig.name, 'disturbance': found.disturbance},
    } | how_found(summary(found), found.settings.to_mapping(), found.result)
    head = 'Gains of the centralized law, written by `satvib tune`; attenuations in dB against 0 V.'
    write_found(path, head, data)


def how_found(
    rows: dict[str, dict[str, float]], settings: dict[str, Any], result: SwarmResult
) -> dict[str, Any]:
    """Give the figures, the settings and the course of a search as plain data."""
    history = result.history
    gained = np.flatnonzero(np.diff(history[:, 1], prepend=np.inf) < 0.0)
    return {
        'figures': {
            name: {k: float(f'{v:.5g}') for k, v in values.items()} for name, values in rows.items()
        },
        'search': settings | {'evaluations': result.evaluations, 'ended': result.reason},
        'cost_history': [[int(n), float(f'{c:.6g}')] for n, c in history[gained]],
    }


def write_found(path: Path, head: str, data: dict[str, Any]) -> None:
    """Write a new YAML file with a line of comment.

    Raises:
        SatvibError: the file is there already, or cannot be written.
    """
    text = yaml.safe_dump(data, sort_keys=False, width=100, default_flow_style=None)
    try:
        with path.open('x', encoding='utf-8') as sink:
            sink.write(f'# {head}\n{text}')
    except FileExistsError:
        raise SatvibError(f'{path}: exists already, not overwritten') from None
    except OSError as error:
        raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None
