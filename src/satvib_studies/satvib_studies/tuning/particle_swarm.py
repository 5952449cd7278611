# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Particle swarm optimization in the constriction form (Clerc and Kennedy 2002).

    v <- chi (v + phi/2 r1 (p - x) + phi/2 r2 (g - x)),   x <- x + v
    chi = 2 / |2 - phi - sqrt(phi^2 - 4 phi)|,  phi = 4.1:  chi = 0.7298

x position, p the particle's best, g the best of its neighbours, r1 and r2 uniform in [0, 1) for every coordinate. A
velocity is clamped to a share of the box; a particle that leaves the box is mirrored at its wall, and its velocity
too.

A swarm whose best has not improved for `stagnation` steps is scattered again, by turns in a small box about the best,
which refines it, and in the whole box without it, which finds others. `patience` of these rounds in vain end the run.

All random numbers of step i come from default_rng([seed, STREAM, i]): a run that is resumed from a checkpoint gives
the bits of one that was never interrupted.

swarm = ParticleSwarm(lower, upper, SwarmSettings(seed=1, budget=4000))
result = swarm.run(cost)                 # cost: positions (particles, n) -> (particles,), the whole swarm in one call
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param

from satvib_studies.tuning.swarm_checkpoint import restore, save

Cost = Callable[[Array], Array]

STREAM = 71
PHI = 4.1
CHI = 2.0 / abs(2.0 - PHI - math.sqrt(PHI * PHI - 4.0 * PHI))
_NEAR = 0.1  # half the width of the small box, as a share of the whole one


@dataclass(frozen=True, kw_only=True)
class SwarmSettings(Schema):
    """How a swarm searches, and when it stops."""

    particles: int = param(24, 'size of the swarm', minimum=2, maximum=100_000)
    budget: int = param(6000, 'evaluations of the cost at most', minimum=1)
    seed: int = param(1, 'seed', minimum=0)
    neighbours: int = param(
        0, 'on a ring, each way, whose best a particle knows; 0: of the whole swarm', minimum=0
    )
    velocity_limit: float = param(
        0.5, 'largest velocity, as a share of the box', above=0.0, maximum=1.0
    )
    stagnation: int = param(25, 'steps without gain after which the swarm is scattered', minimum=1)
    tolerance: float = param(
        1e-6, 'relative gain that counts as none; it is of the best cost', minimum=0.0
    )
    patience: int = param(
        6, 'rounds without gain after which the search ends; 0: only the budget ends it', minimum=0
    )
    target: float | None = param(None, 'a cost at which the search ends; none: no such cost')


@dataclass(frozen=True)
class SwarmResult:
    """What a search found.

    Attributes:
        position: (n,) the best.
        cost: its cost.
        evaluations: of the cost.
        history: (steps, 2) evaluations so far and best cost so far, step by step.
        reason: why it ended: target, tolerance or budget.
    """

    position: Array
    cost: float
    evaluations: int
    history: Array
    reason: str


class ParticleSwarm:
    """A search for the least cost in a box.

    Args:
        lower, upper: (n,) the box.
        settings: see `SwarmSettings`.
        start: (m, n) positions that the first swarm holds, for instance what is in use now; inside the box.

    Raises:
        SatvibError: a box that is none, or a start outside of it.
    """

    def __init__(
        self,
        lower: ArrayLike,
        upper: ArrayLike,
        settings: SwarmSettings | None = None,
        start: ArrayLike | None = None,
    ) -> None:
        self.lower, self.upper = np.array(lower, dtype=float), np.array(upper, dtype=float)
        self.settings = p = settings or SwarmSettings()
        if self.lower.ndim != 1 or self.lower.shape != self.upper.shape or not len(self.lower):
            raise SatvibError('swarm: lower and upper bounds must be lists of equal length')
        if not (np.isfinite(self.upper - self.lower).all() and (self.lower < self.upper).all()):
            worst = int(np.argmin(np.where(self.lower < self.upper, 1, 0)))
            raise SatvibError(
                f'swarm: bounds {self.lower[worst]:g} and {self.upper[worst]:g} of coordinate '
                f'{worst} are no interval'
            )
        self.width = self.upper - self.lower
        shape = (p.particles, len(self.lower))
        draw = np.random.default_rng([p.seed, STREAM, 0])
        self.position = self.lower + self.width * draw.random(shape)
        self.velocity = p.velocity_limit * self.width * (draw.random(shape) - 0.5)
        if start is not None:
            given = np.atleast_2d(np.asarray(start, dtype=float))[: p.particles]
            if given.shape[1:] != shape[1:] or not (
                (given >= self.lower).all() and (given <= self.upper).all()
            ):
                raise SatvibError('swarm: a start is outside the bounds')
            self.position[: len(given)] = given
        self.best_position = self.position.copy()
        self.best_cost = np.full(p.particles, np.inf)
        self.position_found, self.cost_found = self.position[0].copy(), math.inf
        self.steps = self.evaluations = 0
        self.still = self.rounds = 0  # steps and rounds without gain
        self.mark = self.round_mark = math.inf  # what must be improved on
        self.history: list[tuple[float, float]] = []

    def step(self, cost: Cost) -> None:
        """Evaluate the swarm where it is, and move it.

        Raises:
            SatvibError: a cost of the wrong shape.
        """
        values = np.asarray(cost(self.position.copy()), dtype=float)
        if values.shape != (len(self.position),):
            raise SatvibError(
                f'swarm: the cost has the shape {values.shape}, not ({len(self.position)},)'
            )
        values = np.where(np.isnan(values), np.inf, values)
        better = values < self.best_cost
        self.best_position[better] = self.position[better]
        self.best_cost = np.where(better, values, self.best_cost)
        first = int(np.argmin(self.best_cost))
        if self.best_cost[first] < self.cost_found:
            self.position_found = self.best_position[first].copy()
            self.cost_found = float(self.best_cost[first])
        self.steps += 1
        self.evaluations += len(values)
        self.history.append((float(self.evaluations), self.cost_found))
        draw = np.random.default_rng([self.settings.seed, STREAM, self.steps])
        here = float(self.best_cost[first])
        if _gains(here, self.mark, self.settings.tolerance):
            self.mark, self.still = here, 0
        else:
            self.still += 1
        if self.still >= self.settings.stagnation:
            self._scatter(draw)
        else:
            self._move(draw)

    def _move(self, draw: np.random.Generator) -> None:
        p = self.settings
        pull = CHI * 0.5 * PHI
        own, others = draw.random(self.position.shape), draw.random(self.position.shape)
        v = CHI * self.velocity + pull * own * (self.best_position - self.position)
        v = v + pull * others * (self.best_position[self._leaders()] - self.position)
        largest = p.velocity_limit * self.width
        v = np.minimum(np.maximum(v, -largest), largest)
        x = self.position + v
        out = (x < self.lower) | (x > self.upper)
        x = np.where(x < self.lower, 2.0 * self.lower - x, x)
        x = np.where(x > self.upper, 2.0 * self.upper - x, x)
        self.position = np.minimum(np.maximum(x, self.lower), self.upper)
        self.velocity = np.where(out, -v, v)

    def _leaders(self) -> NDArray[np.intp]:
        """Index (particles,) of the best neighbour of each."""
        count, reach = len(self.best_cost), self.settings.neighbours
        if reach == 0 or 2 * reach + 1 >= count:
            return np.full(count, int(np.argmin(self.best_cost)))
        ring = (np.arange(count)[:, None] + np.arange(-reach, reach + 1)) % count
        return ring[np.arange(count), np.argmin(self.best_cost[ring], axis=1)]

    def _scatter(self, draw: np.random.Generator) -> None:
        """Begin a round: even ones near the best and with it, odd ones anywhere and without it."""
        p = self.settings
        gained = _gains(self.cost_found, self.round_mark, p.tolerance)
        self.rounds = 0 if gained else self.rounds + 1
        self.round_mark = self.cost_found
        near = self.rounds % 2 == 0
        low, high = self.lower, self.upper
        if near:
            low = np.maximum(self.position_found - _NEAR * self.width, self.lower)
            high = np.minimum(self.position_found + _NEAR * self.width, self.upper)
        self.position = low + (high - low) * draw.random(self.position.shape)
        self.velocity = p.velocity_limit * (high - low) * (draw.random(self.position.shape) - 0.5)
        self.best_position = self.position.copy()
        self.best_cost = np.full(p.particles, np.inf)
        self.still, self.mark = 0, math.inf
        if near:
            self.best_position[0], self.best_cost[0] = self.position_found, self.cost_found
            self.mark = self.cost_found

    def ended(self) -> str:
        """Why the search is over; empty while it is not."""
        p = self.settings
        if p.target is not None and self.cost_found <= p.target:
            return 'target'
        if p.patience and self.rounds >= p.patience:
            return 'tolerance'
        return 'budget' if self.evaluations + p.particles > p.budget and self.steps else ''

    def result(self) -> SwarmResult:
        """Give what has been found so far."""
        return SwarmResult(
            self.position_found.copy(), self.cost_found, self.evaluations,
            np.array(self.history).reshape(-1, 2), self.ended(),
        )  # fmt: skip

    def run(
        self,
        cost: Cost,
        progress: Callable[['ParticleSwarm'], None] | None = None,
        checkpoint: Path | None = None,
        every: int = 10,
    ) -> SwarmResult:
        """Search until the end.

        Args:
            cost: positions (particles, n) to costs (particles,); NaN counts as infinite.
            progress: called after every step; `cost_found` is the best cost.
            checkpoint: file that is renewed every `every` steps and at the end; one that is there is resumed from.
            every: steps.

        Raises:
            SatvibError: the checkpoint is broken or of another search, or cannot be written.
        """
        if checkpoint is not None and checkpoint.exists():
            restore(self, checkpoint)
        while not self.ended():
            self.step(cost)
            if checkpoint is not None and self.steps % every == 0:
                save(self, checkpoint)
            if progress is not None:
                progress(self)
        if checkpoint is not None:
            save(self, checkpoint)
        return self.result()


def _gains(now: float, before: float, tolerance: float) -> bool:
    """Whether a cost is less than another by more than the tolerance."""
    if not math.isfinite(before):
        return now < before
    return now < before - tolerance * abs(before)
