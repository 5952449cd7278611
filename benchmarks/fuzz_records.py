# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Text files of a known record, written in every layout and damaged in every way: what is made of each.

A record of a known plant is written with a random separator, decimal sign, encoding, preamble, units, offset and size,
and is then damaged or not. Counted: read as written, refused in one line, a wrong model that is not trusted, a
wrong model with a note that names the damage, a wrong model without a word, an error that is no word of satvib, and
files that took more than two seconds. The last three must be 0.

    .venv/bin/python benchmarks/fuzz_records.py --files 100000
"""

import numpy as np
from fuzzing import arguments_of, judged, run
from satvib_common.records.record import column_record
from satvib_ident.models.iir_model import IirModel
from satvib_ident.offline.order_search import identify

SAMPLES = 240
PLANT = IirModel([-1.5, 0.7], [0.0, 1.0, 0.5], 0, 0.01)
DAMAGES = (
    'none', 'none', 'rows lost', 'every tenth row lost', 'rows twice', 'two records glued', 'rows swapped', 'cut',
    'bytes', 'cells missing', 'a cell too many', 'marks', 'blank rows', 'outlier', 'clipped',
    'decimal commas between commas', 'text', 'splice', 'time back', 'columns swapped',
)  # fmt: skip


def make(generator):
    """Times, input, output of a record, and the unit of its output."""
    u = generator.choice([-1.0, 1.0], SAMPLES)
    y = PLANT.simulate(u) + 0.01 * generator.normal(size=SAMPLES)
    unit = 10.0 ** generator.integers(-9, 10)
    offset = generator.choice([0.0, 0.0, 100.0])
    return 0.01 * np.arange(SAMPLES), u, unit * (y + offset), unit


def write(generator, t, u, y, damage):
    """The bytes of a file."""
    separator, decimal = generator.choice([',', ';', '\t', '|', ' ']), generator.choice(['.', ','])
    if damage == 'decimal commas between commas':
        separator = decimal = ','
    elif separator == decimal:
        decimal = '.'
    rows = [[f'{a:.5f}', f'{b:.1f}', f'{c:.9e}'] for a, b, c in zip(t, u, y, strict=True)]
    rows = _damaged_rows(generator, rows, damage)
    lines = [separator.join(cell.replace('.', decimal) for cell in row) for row in rows]
    if damage == 'blank rows':
        for at in generator.integers(0, SAMPLES, 4):
            lines.insert(at, '')
    head = [separator.join(['time', 'u', 'y'])]
    if generator.random() < 0.3:
        head.append(separator.join(['s', 'V', 'm/s^2']))
    if generator.random() < 0.3:
        head = ['Logger 12', f'Rate{separator}100', '', *head]
    text = generator.choice(['\n', '\r\n']).join([*head, *lines, ''])
    data = bytearray(text.encode(generator.choice(['utf-8', 'utf-8-sig', 'utf-16', 'latin-1'])))
    if damage == 'cut':
        del data[generator.integers(0, len(data)) :]
    elif damage == 'bytes':
        for at in generator.integers(0, len(data), generator.integers(1, 6)):
            data[at] = generator.integers(0, 256)
    elif damage == 'splice':
        a, b, c = sorted(generator.integers(0, len(data), 3))
        data = data[:a] + data[b:c] + data[a:b] + data[c:]
    return bytes(data)


def _damaged_rows(generator, rows, damage):
    at = int(generator.integers(10, SAMPLES - 20))
    if damage == 'rows lost':
        del rows[at : at + int(generator.integers(1, 15))]
    elif damage == 'every tenth row lost':
        rows = [row for k, row in enumerate(rows) if k % 10 != 7]
    elif damage == 'rows twice':
        rows[at:at] = (
            [list(row) for row in rows[at - 3 : at]]
            if generator.random() < 0.5
            else [list(rows[at])]
        )
    elif damage == 'two records glued':
        rows = rows[at:] + rows[:at]
    elif damage == 'rows swapped':
        rows[at], rows[at + 1] = rows[at + 1], rows[at]
    elif damage == 'cells missing':
        rows[at] = rows[at][:-1]
    elif damage == 'a cell too many':
        rows[at] = [*rows[at], '1.0']
    elif damage == 'marks':
        for k in generator.integers(0, SAMPLES, 5):
            rows[k][2] = str(generator.choice(['NaN', '', '-', 'N/A', 'inf']))
    elif damage == 'outlier':
        rows[at][2] = f'{1e3 * float(rows[at][2]):.9e}'
    elif damage == 'clipped':
        values = np.array([float(row[2]) for row in rows])
        top = np.quantile(values, 0.95)
        for row in rows:
            row[2] = f'{min(float(row[2]), top):.9e}'
    elif damage == 'text':
        rows[at][1] = 'on'
    elif damage == 'time back':
        rows[at][0] = '-1.00000'
    elif damage == 'columns swapped':
        rows = [[row[0], row[2], row[1]] for row in rows]
    return rows


def outcome(path, unit):
    """What is made of a file, in a word."""
    what, found = judged(lambda: _model(path))
    if found is None:
        return what
    record, result = found
    right = np.allclose(result.model.a, PLANT.a, atol=0.02) and np.allclose(
        result.model.b / unit, PLANT.b, atol=0.05
    )
    if right:
        return 'right'
    if not result.trusted:
        return 'wrong, not trusted'
    notes = [
        n
        for n in record.notes
        if not any(word in n for word in ('sample period', 'read ', 'units'))
    ]
    return 'wrong, said' if notes else 'WRONG, NOT SAID'


def _model(path):
    record = column_record(path, 'u', 'y')
    return record, identify(record.y, record.u, record.dt, [(2, 3, 0)])


def trial(generator, path):
    """Write one record and read it: what was done to it, what came of it."""
    damage = str(generator.choice(DAMAGES))
    t, u, y, unit = make(generator)
    path.write_bytes(write(generator, t, u, y, damage))
    return damage, outcome(path, unit)


if __name__ == '__main__':
    run(trial, arguments_of(__doc__).parse_args(), '.csv')
