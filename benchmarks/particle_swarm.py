# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Particle swarm against differential evolution (scipy) and CMA-ES (cma) at equal budgets.

    ./satvib shell
    pip install --require-hashes -r requirements/benchmarks.lock      # cma, which nothing else needs
    python benchmarks/particle_swarm.py

Every method gets the same box, the same number of evaluations and a random start by its seed; no one knows the untuned
gains. CMA-ES starts again with a doubled population whenever it has converged (IPOP) until its budget is spent.
Prints the median and the worst of ten seeds, as Markdown.
"""

import argparse
import importlib.util
import math
import warnings
from collections.abc import Callable

import numpy as np
from satvib_common.arrays import Array
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.rig.rig import load_rig
from satvib_studies.tuning.cost import CostSettings, TuningCost
from satvib_studies.tuning.particle_swarm import ParticleSwarm, SwarmSettings
from scipy.optimize import differential_evolution

Cost = Callable[[Array], Array]


def sphere(x: Array) -> Array:
    return np.asarray(np.sum((x - 0.3) ** 2, axis=1))


def rosenbrock(x: Array) -> Array:
    return np.asarray(
        np.sum(100.0 * (x[:, 1:] - x[:, :-1] ** 2) ** 2 + (1.0 - x[:, :-1]) ** 2, axis=1)
    )


def rastrigin(x: Array) -> Array:
    return np.asarray(np.sum(x * x - 10.0 * np.cos(2.0 * math.pi * x) + 10.0, axis=1))


def ackley(x: Array) -> Array:
    a = np.exp(-0.2 * np.sqrt(np.mean(x * x, axis=1)))
    return np.asarray(20.0 - 20.0 * a + math.e - np.exp(np.mean(np.cos(2.0 * math.pi * x), axis=1)))


class Budget:
    """Counts evaluations and remembers the best; what is asked for beyond the budget is not counted as found."""

    def __init__(self, cost: Cost, limit: int) -> None:
        self.cost, self.left, self.best = cost, limit, math.inf

    def __call__(self, x: Array) -> Array:
        values = np.asarray(self.cost(x), dtype=float)
        allowed = values[: max(self.left, 0)]
        self.left -= len(values)
        if len(allowed):
            self.best = min(self.best, float(allowed.min()))
        return values


def swarm(cost: Budget, low: Array, high: Array, seed: int, budget: int, particles: int) -> None:
    settings = SwarmSettings(seed=seed, budget=budget, particles=particles, patience=0)
    ParticleSwarm(low, high, settings).run(cost)


def evolution(cost: Budget, low: Array, high: Array, seed: int, budget: int) -> None:
    size = 5 * len(low)
    differential_evolution(
        lambda x: cost(x.T),
        list(zip(low, high, strict=True)),
        popsize=5,
        maxiter=budget // size - 1,
        tol=0.0,
        polish=False,
        vectorized=True,
        updating='deferred',
        rng=seed,
    )


def cma_es(cost: Budget, low: Array, high: Array, seed: int) -> None:
    import cma  # from requirements/benchmarks.lock; nothing else needs it, `main` looks for it

    n, width, population = len(low), high - low, 4 + int(3 * math.log(len(low)))
    draw = np.random.default_rng([seed, 1])
    run = 0
    while cost.left >= population:
        run += 1
        options = {
            'bounds': [0.0, 1.0], 'popsize': population, 'seed': 1000 * seed + run, 'verbose': -9,
        }  # fmt: skip
        search = cma.CMAEvolutionStrategy(draw.random(n), 0.3, options)
        while not search.stop() and cost.left >= population:
            x = search.ask()
            search.tell(x, cost(low + width * np.array(x)).tolist())
        population *= 2


def tuning(plants: int, text: dict[str, object]) -> TuningCost:
    settings = CostSettings(plants=plants)
    return TuningCost(load_rig('soft_3dof'), make_disturbance(text), settings)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--seeds', type=int, default=10)
    parser.add_argument('--budget', type=int, default=4000)
    parser.add_argument('--plants', type=int, default=4)
    parser.add_argument('--particles', type=int, default=24)
    parser.add_argument('--only', default='', help='a part of the name of a problem')
    asked = parser.parse_args()
    warnings.simplefilter('ignore')
    tone = tuning(asked.plants, {'kind': 'sine', 'frequency': 9.0, 'amplitude': 0.5})
    band = tuning(asked.plants, {'kind': 'random', 'low': 2.0, 'high': 50.0, 'rms': 0.5})
    problems: dict[str, tuple[Cost, Array, Array]] = {
        'tuning, 9 Hz': (tone, tone.lower, tone.upper),
        'tuning, 2-50 Hz': (band, band.lower, band.upper),
    }
    for name, function, half, n in (
        ('sphere, 9', sphere, 5.0, 9),
        ('Rosenbrock, 5', rosenbrock, 2.0, 5),
        ('Rastrigin, 5', rastrigin, 5.12, 5),
        ('Ackley, 9', ackley, 30.0, 9),
    ):
        problems[name] = (function, np.full(n, -half), np.full(n, half))
    with_cma = importlib.util.find_spec('cma') is not None
    if not with_cma:
        print(
            'no column of CMA-ES: cma is missing; pip install --require-hashes -r requirements/benchmarks.lock\n'
        )
    if not any(asked.only in name for name in problems):
        parser.error(f'--only: {asked.only!r} is in none of {"; ".join(problems)}')
    print(
        f'{asked.budget} evaluations, {asked.seeds} seeds: median (worst)\n\n'
        '| problem | particle swarm | differential evolution | CMA-ES | swarm over best |\n'
        '|---|---:|---:|---:|---:|'
    )
    for name, (cost, low, high) in problems.items():
        if asked.only not in name:
            continue
        found: dict[str, list[float]] = {'swarm': [], 'evolution': [], 'cma': []}
        if not with_cma:
            del found['cma']
        for seed in range(1, asked.seeds + 1):
            for method, row in found.items():
                count = Budget(cost, asked.budget)
                if method == 'swarm':
                    swarm(count, low, high, seed, asked.budget, asked.particles)
                elif method == 'evolution':
                    evolution(count, low, high, seed, asked.budget)
                else:
                    cma_es(count, low, high, seed)
                row.append(count.best)
        cells = [f'{np.median(row):.4g} ({max(row):.4g})' for row in found.values()]
        cells += [] if with_cma else ['–']
        best = min(float(np.median(row)) for row in found.values())
        ratio = float(np.median(found['swarm'])) / best if best > 0.0 else math.nan
        print(f'| {name} | {" | ".join(cells)} | {ratio:.3f} |', flush=True)


if __name__ == '__main__':
    main()
