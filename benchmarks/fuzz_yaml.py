# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Settings files, damaged and filled with odd values: each is loaded, or refused in one line, at once.

Scenarios, rigs, campaigns, sweeps, models and gains are damaged as bytes or as lines, and values are replaced by what
people and tools leave in files: templates, dates, long numbers, nested aliases, tags, escapes, infinities.

    .venv/bin/python benchmarks/fuzz_yaml.py --files 100000 --log yaml.json
"""

from pathlib import Path

from fuzzing import arguments_of, damage, judged, run
from satvib_experiment.scenario.scenario import load_scenario
from satvib_ident.models.model_file import load_model
from satvib_plant_sim.rig.any_rig import load_any_rig
from satvib_studies.campaign.settings import load_campaign
from satvib_studies.sweep.sweep import load_sweep

import satvib_experiment
import satvib_plant_sim
import satvib_studies

MODEL = (
    b'format: satvib-model-1\nmodel:\n  delay: 0\n  sample_period: 0.01\n  a: [-1.5, 0.7]\n'
    b'  b: [0.0, 1.0, 0.5]\nabout: {}\n'
)


def _files(package, folder):
    return sorted((Path(package.__file__).parent / folder).glob('*.yaml'))


LOADERS = {
    'scenario': (load_scenario, [p.read_bytes() for p in _files(satvib_experiment, 'scenarios')]),
    'rig': (
        lambda path: load_any_rig(str(path)),
        [p.read_bytes() for p in _files(satvib_plant_sim, 'rigs')],
    ),
    'campaign': (load_campaign, [p.read_bytes() for p in _files(satvib_studies, 'campaigns')]),
    'sweep': (load_sweep, [p.read_bytes() for p in _files(satvib_studies, 'sweeps')]),
    'model': (load_model, [MODEL]),
}
ODD = (
    b'{{ value }}', b'{% if x %}', b'2026-13-45', b'2026-02-30', b'1' + b'0' * 400, b'.inf', b'-.inf', b'.nan',
    b'1e308', b'-1e308', b'1e-320', b'0', b'-1', b'true', b'null', b'~', b'', b'[]', b'{}', b'[[[]]]',
    b'{a: {b: {c: d}}}', b'"\\0"', b'"\\x1b[31m"', b'"\\ud800"', b'"a/b"', b'..', b'!!python/object:os.system ls',
    b'!!binary AA==', b'!!set {a, b}', b'!t x', b'*a', b'&a [*a]', b'<<: *a', b'? [a]', b'- - - a', b'"\n"', b"'",
    b'"', b'|', b'>-\n', b'0x' + b'f' * 40, b'1_000', b'0o777', b'12:30:45', b'1e999999999', b'9' * 5000, b'[' * 80,
    b'{a: ' * 60, b'[1, 2, 3, 4, 5, 6, 7, 8]', b'paper_3dof', b'[reds]', b'\xff\xfe', b'\xc3(', b'\xe2\x80\xae',
    b'\t', b'\r', b'%YAML 9.9', b'---', b'...', b'# only', b'1,5', b'10 Hz', b'9007199254740993', b'1e12',
    b'1000000000', b'99999999999999999999',
)  # fmt: skip
BOMB = (
    b'a: &a [x, x, x, x, x, x, x, x, x]\nb: &b [*a, *a, *a, *a, *a, *a, *a, *a, *a]\n'
    b'c: &c [*b, *b, *b, *b, *b, *b, *b, *b, *b]\nd: &d [*c, *c, *c, *c, *c, *c, *c, *c, *c]\n'
    b'e: &e [*d, *d, *d, *d, *d, *d, *d, *d, *d]\nf: &f [*e, *e, *e, *e, *e, *e, *e, *e, *e]\n'
)


def _odd_lines(generator, data):
    """Change lines: values replaced, lines moved, doubled, left out, indented."""
    lines = data.split(b'\n')
    for _ in range(generator.integers(1, 4)):
        at = int(generator.integers(0, len(lines)))
        what = generator.integers(0, 8)
        if what < 4:
            key, colon, _ = lines[at].partition(b':')
            lines[at] = key + colon + b' ' + ODD[generator.integers(0, len(ODD))]
        elif what == 4:
            lines.insert(int(generator.integers(0, len(lines))), lines[at])
        elif what == 5 and len(lines) > 1:
            del lines[at]
        elif what == 6:
            lines[at] = b' ' * int(generator.integers(0, 9)) + lines[at].lstrip()
        else:
            lines.insert(at, ODD[generator.integers(0, len(ODD))])
    return b'\n'.join(lines)


def trial(generator, path):
    """Write one file and load it: which kind and what was done to it, what came of it."""
    name = str(generator.choice(list(LOADERS)))
    load, files = LOADERS[name]
    data = files[generator.integers(0, len(files))]
    other = files[generator.integers(0, len(files))]
    if generator.random() < 0.6:
        what, data = 'lines', _odd_lines(generator, data)
        if generator.random() < 0.1:
            data = BOMB + data.replace(b': ', b': *f # ', 1)
    else:
        what, data = damage(generator, data, other)
    path.write_bytes(data)
    found, _ = judged(lambda: load(path))
    return f'{name}, {what}', found


if __name__ == '__main__':
    run(trial, arguments_of(__doc__).parse_args(), '.yaml')
