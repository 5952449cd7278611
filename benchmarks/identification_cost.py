# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an update of a five-parameter estimator costs, beside padasip's RLS, on one core.

    .venv/bin/python benchmarks/identification_cost.py [--streams 3000] [--updates 400] [--rounds 7]

Times are processor time, the best of the rounds, in microseconds per update and stream; every round measures
everything, so that a busy machine is unfair to nobody. Memory is what the arrays of an estimator hold per stream.
All guards are on: samples that are not finite, bounds, the limit of P, the sums for the noise variance.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / 'src' / package) for package in ('satvib_common', 'satvib_ident')]

import numpy as np  # noqa: E402
import padasip  # noqa: E402
from satvib_common.phases import Phase  # noqa: E402
from satvib_ident.estimators.extended import ExtendedLeastSquares  # noqa: E402
from satvib_ident.estimators.instrumental import InstrumentalVariable  # noqa: E402
from satvib_ident.estimators.least_squares import RecursiveLeastSquares  # noqa: E402
from satvib_ident.forgetting import (  # noqa: E402
    CovarianceResetting,
    DeadZone,
    DirectionalForgetting,
    ExponentialForgetting,
    FiniteWindow,
    NoForgetting,
    VariableRateForgetting,
)
from satvib_ident.identifier import IdentifierCore  # noqa: E402
from satvib_ident.models.iir_model import IirModel  # noqa: E402
from satvib_ident.parameters import IdentifierParameters  # noqa: E402

ESTIMATORS = {
    'least squares': lambda s: RecursiveLeastSquares(5, s, NoForgetting()),
    '  exponential': lambda s: RecursiveLeastSquares(5, s, ExponentialForgetting(0.98), limit=1e6),
    '  variable rate': lambda s: RecursiveLeastSquares(5, s, VariableRateForgetting(), limit=1e6),
    '  directional': lambda s: RecursiveLeastSquares(
        5, s, DirectionalForgetting(0.98, test=VariableRateForgetting()), limit=1e6
    ),
    '  resetting': lambda s: RecursiveLeastSquares(5, s, CovarianceResetting(1e-3, 1.0)),
    '  dead zone': lambda s: RecursiveLeastSquares(5, s, DeadZone(0.005)),
    '  window of 200': lambda s: RecursiveLeastSquares(5, s, FiniteWindow(200)),
    'extended': lambda s: ExtendedLeastSquares(5, 2, s),
    'instrumental': lambda s: InstrumentalVariable(2, 3, 2, s),
}


def regressions(streams: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Regressors (count, streams, 5) and outputs (count, streams) of the paper's G(z), each stream its own signals."""
    generator = np.random.default_rng([1])
    u = generator.choice([-1.0, 1.0], size=(streams, count + 2))
    clean = IirModel([-0.460, 0.158], [0.061, -0.103, 0.033], 0, 0.01).simulate(u)
    y = clean + 0.005 * generator.normal(size=u.shape)
    rows = [-y[:, 1:-1], -y[:, :-2], u[:, 2:], u[:, 1:-1], u[:, :-2]]
    w = np.stack(rows, axis=-1).swapaxes(0, 1)
    return np.ascontiguousarray(w), np.ascontiguousarray(y[:, 2:].T)


def best_of(runs: dict[str, tuple[Callable[[], None], int]], rounds: int) -> dict[str, float]:
    """Best processor time of each run over interleaved rounds, us per unit of its count."""
    times = dict.fromkeys(runs, float('inf'))
    for _ in range(rounds):
        for name, (run, count) in runs.items():
            start = time.process_time()
            run()
            times[name] = min(times[name], (time.process_time() - start) / count * 1e6)
    return times


def held(thing: object, seen: set[int] | None = None) -> int:
    """Bytes of all arrays that an object holds, each counted once."""
    seen = set() if seen is None else seen
    if id(thing) in seen:
        return 0
    seen.add(id(thing))
    if isinstance(thing, np.ndarray):
        return thing.nbytes
    if hasattr(thing, '__dict__'):
        return sum(held(value, seen) for value in vars(thing).values())
    return 0


def singles(w: np.ndarray, y: np.ndarray, make: Callable) -> Callable[[], None]:
    """One stream through an estimator, sample by sample."""
    estimator = make(())

    def run() -> None:
        for k in range(len(y)):
            estimator.update(w[k], y[k])

    run()
    return run


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--streams', type=int, default=3000)
    parser.add_argument('--updates', type=int, default=400)
    parser.add_argument('--rounds', type=int, default=15)
    options = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    count, streams, few = options.updates, options.streams, max(options.updates // 10, 5)
    wide_w, wide_y = regressions(streams, few)
    w, y = (np.ascontiguousarray(a[:, 0]) for a in regressions(1, count))

    theirs = padasip.filters.FilterRLS(5, mu=0.98)

    def run_theirs() -> None:
        for k in range(count):
            theirs.adapt(y[k], w[k])

    runs: dict[str, tuple[Callable[[], None], int]] = {'padasip': (run_theirs, count)}
    bytes_held = {}
    for name, make in ESTIMATORS.items():
        runs[f'1 {name}'] = (singles(w, y, make), count)
        many = make((streams,))

        def run_many(many: RecursiveLeastSquares = many) -> None:
            for k in range(few):
                many.update(wide_w[k], wide_y[k])

        for _ in range(3):  # past warm-up and filled windows
            run_many()
        runs[f'n {name}'] = (run_many, few * streams)
        bytes_held[name] = held(many) / streams
    samples = [(np.asarray(a), np.asarray(b)) for a, b in zip(y, w[:, 2], strict=True)]
    for phase in (Phase.IDENTIFY, Phase.CONTROL):
        core, place = IdentifierCore(IdentifierParameters()), [0]

        def run_core(
            core: IdentifierCore = core, place: list[int] = place, phase: Phase = phase
        ) -> None:
            for value, drive in samples:
                core.step(place[0], phase, value, drive)
                place[0] += 1

        run_core()
        runs[f'identifier, {phase.name}'] = (run_core, count)
    times = best_of(runs, options.rounds)

    reference = times['padasip']
    wide = f'{streams} [us]'
    print(f'{"":22}{"single [us]":>12}{"of padasip":>12}{wide:>12}{"faster":>9}{"bytes":>8}')
    print(f'{"padasip FilterRLS":22}{reference:12.2f}{1.0:12.2f}{"-":>12}{"-":>9}{held(theirs):8d}')
    for name in ESTIMATORS:
        single, batched = times[f'1 {name}'], times[f'n {name}']
        print(
            f'{name:22}{single:12.2f}{single / reference:12.2f}{batched:12.3f}'
            f'{reference / batched:9.0f}{bytes_held[name]:8.0f}'
        )
    for name in ('identifier, IDENTIFY', 'identifier, CONTROL'):
        print(f'{name:22}{times[name]:12.2f}{times[name] / reference:12.2f}')


if __name__ == '__main__':
    main()
