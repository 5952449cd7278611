# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Runs a trial for every number of a range, and counts what came of it; the range goes on where it was stopped.

Trial i of a seed is always the same file, so one that failed can be made again. Each trial has two seconds of processor
time; the process may grow by 500 MB. Whatever begins with ERROR or WRONG is a defect, and its file is kept.
"""

import argparse
import collections
import contextlib
import json
import resource
import signal
import tempfile
import time
from pathlib import Path

import numpy as np
from satvib_common.errors import SatvibError

LONGEST = 2.0  # s of processor time
LARGEST = 500.0  # MB
SAVE_EVERY = 200


class TooLong(BaseException):
    """A trial took too long; not an `Exception`, so that no reader takes it for damage."""


@contextlib.contextmanager
def limited(seconds=LONGEST):
    """Raise `TooLong` when the block takes more than so many seconds of processor time."""

    def expired(*_):
        raise TooLong

    before = signal.signal(signal.SIGPROF, expired)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def judged(action):
    """Do something to a file; gives what came of it in a word, and what was read (None: nothing)."""
    try:
        with limited():
            return 'read', action()
    except TooLong:
        return f'ERROR: more than {LONGEST:g} s', None
    except SatvibError as error:
        if not str(error).isprintable():
            return 'ERROR: not one line', None
        return 'refused', None
    except Exception as error:  # noqa: BLE001 - what is looked for
        return f'ERROR: {type(error).__name__}: {error}'[:120], None


def arguments_of(description):
    """Give the parser of a script's command line."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument(
        '--files', type=int, default=1000, help='how many, those done before included'
    )
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--keep', type=Path, help='folder for the files of defects')
    parser.add_argument(
        '--log', type=Path, help='JSON file with the counts; one that is there is gone on from'
    )
    return parser


def run(trial, arguments, suffix):
    """Run the trials of a range and print the counts.

    Args:
        trial: takes a generator and the path for its file; gives a label and what came of it.
        arguments: of the command line.
        suffix: of the files.
    """
    state = {'next': 0, 'counts': {}, 'slowest': 0.0, 'memory': 0.0}
    if arguments.log and arguments.log.exists():
        state = json.loads(arguments.log.read_text())
    counts = collections.defaultdict(collections.Counter)
    for label, found in state['counts'].items():
        counts[label].update(found)
    base = _memory()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f'file{suffix}'
        for i in range(state['next'], arguments.files):
            start = time.process_time()
            label, what = trial(np.random.default_rng([arguments.seed, i]), path)
            state['slowest'] = max(state['slowest'], time.process_time() - start)
            grown = _memory() - base
            if grown > LARGEST:
                what, base = f'ERROR: more than {LARGEST:g} MB', _memory()
            state['memory'] = max(state['memory'], grown)
            counts[label][what] += 1
            if what[0] in 'EW' and arguments.keep:
                arguments.keep.mkdir(parents=True, exist_ok=True)
                (arguments.keep / f'{arguments.seed}_{i}_{label}{suffix}').write_bytes(
                    path.read_bytes()
                )
            if arguments.log and ((i + 1) % SAVE_EVERY == 0 or i + 1 == arguments.files):
                kept = {'next': i + 1, 'counts': {k: dict(v) for k, v in counts.items()}}
                arguments.log.write_text(json.dumps(state | kept))
    show(counts, arguments.files, state)


def show(counts, files, state):
    """Print the counts as a table."""
    columns = sorted({what for count in counts.values() for what in count})
    print('| file | ' + ' | '.join(columns) + ' |\n|' + '---|' * (len(columns) + 1))
    for label, count in sorted(counts.items()):
        print(f'| {label} | ' + ' | '.join(str(count[what]) for what in columns) + ' |')
    print(
        f'\n{files} files; slowest {state["slowest"]:.2f} s of processor time, the process grew by '
        f'{state["memory"]:.0f} MB'
    )


def damage(generator, data, other=b''):
    """Damage bytes: some changed, eight at once, cut, a piece moved, doubled or taken out, a piece of another file.

    Returns:
        What was done, and the bytes.
    """
    data = bytearray(data)
    kinds = ('bytes', 'number', 'cut', 'splice', 'double', 'hole', 'zeros', 'other')
    what = str(generator.choice(kinds))
    a, b = sorted(int(n) for n in generator.integers(0, max(len(data), 1), 2))
    if what == 'bytes':
        for at in generator.integers(0, max(len(data), 1), generator.integers(1, 9)):
            data[at] = generator.integers(0, 256)
    elif what == 'number':
        width = int(generator.choice([2, 4, 8]))
        data[a : a + width] = (
            generator.bytes(width) if generator.random() < 0.5 else b'\xff' * width
        )
    elif what == 'cut':
        del data[a:]
    elif what == 'splice':
        to = int(generator.integers(0, len(data) + 1))
        piece = data[a:b]
        del data[a:b]
        data[to:to] = piece
    elif what == 'double':
        data[b:b] = data[a:b]
    elif what == 'hole':
        del data[a:b]
    elif what == 'zeros':
        data[a:b] = bytes(b - a)
    elif what == 'other':
        data[a:b] = other[a:b]
    return what, bytes(data)


def _memory():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main():
    """Print the counts of a log, also while its run goes on."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('log', type=Path, help='JSON file of a run')
    state = json.loads(parser.parse_args().log.read_text())
    counts = {label: collections.Counter(found) for label, found in state['counts'].items()}
    show(counts, state['next'], state)


if __name__ == '__main__':
    main()
