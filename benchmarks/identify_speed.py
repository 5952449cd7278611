# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What `satvib identify` costs on a long record, beside one `numpy.linalg.lstsq` of the largest order.

The record is PRBS of 1 V through a plant of two poles, with noise on the output; time and processor time of
one run, and the memory of the process. `--text FOLDER` also writes and reads the record as CSV.

    .venv/bin/python benchmarks/identify_speed.py --samples 1000000
"""

import argparse
import resource
import time
from pathlib import Path

import numpy as np
from satvib_ident.models.iir_model import IirModel
from satvib_ident.offline.delay import find_delay
from satvib_ident.offline.order_search import identify

ORDERS = [(n, n + 1, 0) for n in range(1, 9)]


def record(samples):
    """Output and input of the plant."""
    generator = np.random.default_rng([16])
    u = generator.choice([-1.0, 1.0], samples)
    y = IirModel([-1.5, 0.7], [0.0, 1.0, 0.5], 0, 0.01).simulate(u)
    return y + 0.05 * generator.normal(size=samples), u


def timed(what, call):
    """Run a call and print how long it took and the largest memory until then; give its processor time."""
    start, busy = time.perf_counter(), time.process_time()
    result = call()
    elapsed, busy = time.perf_counter() - start, time.process_time() - busy
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f'| {what} | {elapsed:.1f} | {busy:.1f} | {memory:.0f} |', flush=True)
    return busy, result


def batch(y, u, n):
    """Least squares of order n with numpy: rows and solution."""
    columns = [-y[n - i : len(y) - i] for i in range(1, n + 1)] + [
        u[n - i : len(u) - i] for i in range(n + 1)
    ]
    return np.linalg.lstsq(np.column_stack(columns), y[n:], rcond=None)[0]


def main():
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--samples', type=int, default=1_000_000)
    parser.add_argument('--methods', nargs='*', default=['extended', 'instrumental'])
    parser.add_argument('--text', type=Path)
    arguments = parser.parse_args()
    y, u = record(arguments.samples)
    identify(y[:2000], u[:2000], 0.01, ORDERS)  # kernels are loaded
    for method in arguments.methods:
        identify(y[:2000], u[:2000], 0.01, ORDERS, method)
    print(
        '| what | time [s] | processor time [s] | memory of the process [MB] |\n|---|---|---|---|'
    )
    one, result = timed(
        'identify, orders 1 to 8, least squares', lambda: identify(y, u, 0.01, ORDERS)
    )
    timed('identify, order 8 alone', lambda: identify(y, u, 0.01, ORDERS[-1:]))
    timed('search of the delay', lambda: find_delay(y, u))
    for method in arguments.methods:
        timed(
            f'identify, orders 1 to 8, {method}', lambda m=method: identify(y, u, 0.01, ORDERS, m)
        )
    if arguments.text:
        _text(arguments.text, y, u)
    reference, theta = timed('numpy.linalg.lstsq, order 8', lambda: batch(y, u, 8))
    model = result.candidates[-1].model
    print(f'\nall orders: {one / reference:.1f} times the processor time of lstsq of order 8; largest difference of '
          f'parameters {np.max(np.abs(model.theta - theta)):.1e}')  # fmt: skip


def _text(folder, y, u):
    from satvib_common.records.record import column_record

    path = folder / 'long.csv'
    t = np.arange(len(y)) * 0.01
    np.savetxt(
        path, np.column_stack([t, u, y]), fmt='%.6g', delimiter=',', header='t,u,y', comments=''
    )
    timed(
        f'reading {path.stat().st_size / 1e6:.0f} MB of CSV', lambda: column_record(path, 'u', 'y')
    )
    path.unlink()


if __name__ == '__main__':
    main()
