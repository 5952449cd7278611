# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Law narrowband on the international benchmark on adaptive regulation, with one setting for all of it.

    ./satvib shell
    python benchmarks/active_suspension.py                # all tables: half a minute
    python benchmarks/active_suspension.py --short        # two noise segments, no random frequencies
    python benchmarks/active_suspension.py --page docs/narrowband.md [--model identified]

The law gets the band, the model and nothing else: not the level, not the number of tones, not when they change.
Each figure stands beside that of an oracle which knows every frequency at every sample, on the same noise. The
benchmark's limits are limited by its noise: what counts is to be within 0.5 dB of the oracle, and inside the limits
wherever the oracle is. `model` is the benchmark's own, or one identified from 40 s of noisy data (see `identified`).
"""

import argparse
import time
from pathlib import Path


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--segments', type=int, default=5, help='noise segments')
    parser.add_argument('--random', type=int, default=20, help='random frequencies')
    parser.add_argument('--model', choices=('exact', 'identified'), default='exact')
    parser.add_argument('--short', action='store_true')
    parser.add_argument(
        '--page', type=Path, help='page with the marks <!-- table steady exact --> ...'
    )
    options = parser.parse_args()

    # after the options, so that --help is quick
    from satvib_studies.benchmark import active_suspension as bench
    from satvib_studies.benchmark import active_suspension_protocol as asp
    from satvib_studies.sweep.tables import fill

    if not asp.data_path().exists():
        print(f'no benchmark data at {asp.data_path()}: nothing to run')
        return
    begun = time.perf_counter()
    size = (2, 0) if options.short else (options.segments, options.random)
    tables = bench.run(*size, options.model)
    print(f'Law narrowband, {options.model} model, seed {bench.SEED}, noise segments 0 to {size[0] - 1}, '
          f'setting {bench.SETTING}')  # fmt: skip
    heads = {
        'steady': 'Simple steps: dB; GA as the benchmark has it (twice the ordinary dB)',
        'random': 'Random frequencies, each on its own noise segment (100 and on)',
        'steps': 'Step changes every 3 s: peaks in 1e-3 V, settling in s, fall of the power in dB',
        'chirp': 'Chirps: 1e-3 V',
    }
    texts = {name: bench.markdown(table) for name, table in tables.items()}
    for name, text in texts.items():
        print(f'\n{heads[name]}\n\n{text}', end='')
    texts['summary'] = bench.summary(tables)
    print('\n' + texts['summary'], end='')
    if options.page is not None:
        fill(options.page, {f'table {n} {options.model}': t for n, t in texts.items()})
    print(f'{time.perf_counter() - begun:.0f} s')


if __name__ == '__main__':
    main()
