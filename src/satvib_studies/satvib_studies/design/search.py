# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The search for the free numbers of a design, by the cost and on the plants of the centralized law's gains.

    found = DesignSearch(load_rig('soft_3dof'), disturbance, DesignSettings(design='lqg')).run()
    write_design(found, Path('lqg.yaml'))

Each candidate is designed on the rig as it is. It is judged on it and on the perturbed plants
(`satvib_studies.tuning.cost`). Whether a loop is stable is asked of its poles: a narrow notch turns the phase between
two frequencies of a grid. The poles also tell the longest time constant t of a loop. A level by frequency is that of a
loop that has settled, so the narrowest notch would be the best one, and would need minutes for it. Therefore

    J = J of the cost + penalty max(1 - settling / t, 0)^2
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.arrays import Array, Complex, Mask
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param
from satvib_control.laws.state_space.matrices import Matrices, response
from satvib_experiment.scenario.memory import check_needs
from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.responses.all_struts import sampled_rig
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.design.closed_loop import closed_loop_matrix, for_every_strut
from satvib_studies.design.kinds import Kind, lqg_kind, notch_kind
from satvib_studies.tuning.cost import UNSTABLE, CostSettings, TuningCost
from satvib_studies.tuning.figure import draw_search, frequencies
from satvib_studies.tuning.particle_swarm import ParticleSwarm, SwarmResult, SwarmSettings
from satvib_studies.tuning.search import SwarmSearch, how_found, summary_row, write_found

_TIME = 0.02  # s; of one candidate on one plant, at least


@dataclass(frozen=True, kw_only=True)
class DesignSettings(Schema):
    """Settings of a search."""

    design: str = param('lqg', 'what is designed', choices=('lqg', 'notch'))
    tone: float = param(
        0.0,
        'nominal frequency of the tone; 0: the only one of the disturbance',
        unit='Hz',
        minimum=0.0,
    )
    settling: float = param(
        1.0, 'longest time constant of a loop that costs nothing', unit='s', above=0.0
    )
    cost: CostSettings = param(CostSettings(), 'what counts')
    swarm: SwarmSettings = param(SwarmSettings(budget=960), 'how it is looked for')


@dataclass(frozen=True)
class Designed:
    """What a search found.

    Attributes:
        search: what was searched.
        result: of the swarm.
    """

    search: DesignSearch
    result: SwarmResult

    def values(self) -> dict[str, float]:
        """Give the free numbers that were found."""
        return self.search.kind.values(self.result.position)

    def parameters(self) -> dict[str, Any]:
        """Give the law and its matrices as the section of a scenario that `kind.section` names."""
        matrices = self.search.kind.make(self.values())
        return {'law': 'state_space', **matrices.parameters()}

    def summary(self) -> dict[str, dict[str, float]]:
        """Give the figures of the design found and of the one at which the search began."""
        return {
            name: self.search.row(position)
            for name, position in (('tuned', self.result.position), ('untuned', self.search.start))
        }


@dataclass
class DesignSearch(SwarmSearch):
    """A search that is set up and can be run.

    Args:
        rig: a rig with a geometry.
        disturbance: plain data.
        settings: see `DesignSettings`.

    Raises:
        SatvibError: a rig of identified models, a wrong disturbance, or one without a nominal tone.
    """

    rig: Any
    disturbance: dict[str, Any]
    settings: DesignSettings = field(default_factory=DesignSettings)

    def __post_init__(self) -> None:
        """Set the cost and the box up."""
        if not isinstance(self.rig, Rig):
            raise SatvibError(f'rig {self.rig.name}: identified models have no modes to control')
        s = self.settings
        check_needs(
            f'swarm.budget, cost.plants: {s.swarm.budget} evaluations on {s.cost.plants} plants',
            seconds=_TIME * s.swarm.budget * s.cost.plants,
        )
        built = make_disturbance(self.disturbance, '--disturbance')
        self.tone = _nominal(built.tones(), s.tone, self.rig)
        near = np.geomspace(1e-4, 0.3, 24)
        self.cost = TuningCost(
            self.rig,
            built,
            s.cost,
            [*self.tone * (1.0 - near), self.tone, *self.tone * (1.0 + near)],
        )
        self.kind = self._kind()
        self.lower, self.upper, self.start = self.kind.box()
        self._plants = [sampled_rig(plant) for plant in self.cost.plants]

    def _kind(self) -> Kind:
        if self.settings.design == 'notch':
            return notch_kind(self.rig, self.tone, self.settings.cost.corner)
        power = self.cost.power.sum(axis=1) * (
            np.abs(self.cost.frequency - self.tone) < 1e-6 * self.tone
        )
        level = math.sqrt(float(power.sum()))
        directions = tuple(tuple(map(float, row)) for row in self.cost.sources)
        return lqg_kind(self.rig, self.tone, level, directions if self.rig.struts.each else ())

    def judge(self, position: Array) -> tuple[Array, Array]:
        """Give the figures (plants, 4 + modes) and the largest magnitudes of the poles (plants,) of one candidate.

        Raises:
            SatvibError: there is no such design.
        """
        one = self.kind.make(self.kind.values(position))
        whole = for_every_strut(one, self.rig.struts.count) if self.kind.alone else one
        loops = (closed_loop_matrix(plant, whole) for plant in self._plants)
        radius = np.array([np.abs(np.linalg.eigvals(loop)).max() for loop in loops])
        return self.cost.controller_figures(self._law(one, self.cost.frequency)), radius

    def _law(self, one: Matrices, frequency: Array) -> Complex:
        """C (f, n, n) of a controller at (f,) Hz, u = -C y."""
        omega = 2.0 * math.pi * frequency * self.rig.acquisition.period
        every = np.eye(self.rig.struts.count) if self.kind.alone else 1.0
        return np.ascontiguousarray(-response(one, omega) * every)

    def law(self, position: Array, frequency: Array) -> Complex:
        """Give C (f, n, n) of a candidate at (f,) Hz, u = -C y."""
        return self._law(self.kind.make(self.kind.values(position)), frequency)

    def each(self, position: Array) -> Array:
        """Give J (plants,) of one candidate; infinite where there is no such design."""
        try:
            figures, radius = self.judge(position)
        except SatvibError:
            return np.full(len(self._plants), math.inf)
        astray = UNSTABLE * (1.0 + np.minimum(radius - 1.0, 1.0))
        slow = np.maximum(1.0 - self.settings.settling / self._time_constant(radius), 0.0)
        J = self.cost.of_stable(figures) + self.settings.cost.penalty * slow**2
        return np.asarray(np.where(stable(radius), J, astray))

    def _time_constant(self, radius: Array) -> Array:
        """Give the time constants (plants,) of stable loops, s, from the largest magnitudes of their poles."""
        inside = np.minimum(radius, 1.0 - 1e-12)
        return np.asarray(-self.rig.acquisition.period / np.log(inside))

    def __call__(self, positions: Array) -> Array:
        """Give the cost (particles,) of positions (particles, free)."""
        return np.array([float(self.cost.together(self.each(x))) for x in positions])

    def row(self, position: Array) -> dict[str, float]:
        """Give what is worth telling of one candidate, as `satvib_studies.tuning.search.summary` does."""
        figures, radius = self.judge(position)
        found = summary_row(self.cost, figures, float(self.cost.together(self.each(position))))
        slowest = float(self._time_constant(radius).max())
        return found | {'stable_plants': float(np.sum(stable(radius))), 'slowest': slowest}

    def swarm(self) -> ParticleSwarm:
        """Give the swarm as it begins."""
        return ParticleSwarm(self.lower, self.upper, self.settings.swarm, start=self.start)

    def run(
        self,
        progress: Callable[[ParticleSwarm], None] | None = None,
        checkpoint: Path | None = None,
    ) -> Designed:
        """Search; see `ParticleSwarm.run`."""
        return Designed(self, self.swarm().run(self, progress, checkpoint))


def stable(radius: Array) -> Mask:
    """Whether loops are stable whose largest poles have these magnitudes."""
    return np.asarray(radius < 1.0)


def _nominal(tones: tuple[float, ...], wanted: float, rig: Rig) -> float:
    """Give the nominal frequency of the tone, Hz."""
    half = 0.5 * rig.acquisition.sample_rate
    if not wanted and len(tones) != 1:
        raise SatvibError(
            f'tone: the disturbance has {len(tones) or "no"} tones; say which frequency the design is for'
        )
    found = wanted or tones[0]
    if not found < half:
        raise SatvibError(f'tone: {found} Hz is not below half the sample rate, {half} Hz')
    return found


def write_design(found: Designed, path: Path) -> None:
    """Write what a scenario takes as `centralized: {file: ...}` or `controller: {file: ...}`, and where it comes from.

    Raises:
        SatvibError: the file is there already, or cannot be written.
    """
    search = found.search
    data = {
        search.kind.section: found.parameters(),
        'designed_for': {
            'rig': search.rig.name, 'disturbance': search.disturbance, 'tone': search.tone,
        },
        'design': {name: float(f'{v:.5g}') for name, v in found.values().items()},
    }  # fmt: skip
    data |= how_found(found.summary(), search.settings.to_mapping(), found.result)
    head = 'A controller for the law state_space, written by `satvib tune`; attenuations in dB against 0 V.'
    write_found(path, head, data)


def draw_design(found: Designed, path: Path) -> None:
    """Draw how the cost fell, and the transmission from the source to the payload on all plants."""
    search = found.search
    frequency = np.union1d(
        frequencies(search.rig), search.cost.frequency[search.cost.frequency > 0.5]
    )
    laws = {
        '0 V': np.zeros(
            (len(frequency), search.rig.struts.count, search.rig.struts.count), dtype=complex
        ),
        'untuned': search.law(search.start, frequency),
        'tuned': search.law(found.result.position, frequency),
    }
    start = float(search(search.start[None])[0])
    draw_search(path, search.cost.plants, found.result.history, start, frequency, laws)
