# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Plays every fault of the fault suite on a running graph, several times, and writes the tables of docs/faults.md.

    ./satvib shell -c 'python benchmarks/faults.py --rounds 5'
    ./satvib shell -c 'python benchmarks/faults.py --rounds 1 --only "20 V"'

The faults, what must happen and the limits are in tests/faults/faults.py. Exit code 1: something did not hold.
"""

import argparse
import sys
import tempfile
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / 'tests'), str(ROOT / 'tests' / 'faults')]

from faults import CHAPTERS, ENDINGS, IN_EACH, Fault  # noqa: E402 - they live with the tests
from play import Outcome, Scene  # noqa: E402
from processes import Probe, Starter, own_domain  # noqa: E402
from satvib_common.phases import Phase  # noqa: E402
from table import write  # noqa: E402

PAGE = ROOT / 'docs' / 'faults.md'


class Record:
    """What was measured, and what did not hold."""

    def __init__(self) -> None:
        self.outcomes: dict[str, list[Outcome]] = defaultdict(list)
        self.broken: list[str] = []

    def add(self, where: str, name: str, outcome: Outcome) -> None:
        self.outcomes[name].append(outcome)
        self.broken += [f'{where}: {name}: {text}' for text in outcome.broken]
        print(f'{where}: {name}: {outcome}', flush=True)


def play(
    record: Record,
    where: str,
    faults: Sequence[Fault],
    phase: Phase,
    ending: Fault | None,
    seed: int,
) -> None:
    """Play faults on a graph of their own; what ends it unexpectedly is written down, and the rest is left out."""
    with tempfile.TemporaryDirectory() as name, own_domain(Path(name)):
        start, probe = Starter(Path(name), quiet=True), Probe()
        now = 'the start'
        try:
            scene = Scene(start, probe, phase)
            for i, fault in enumerate(faults):
                now = fault.name
                record.add(where, now, scene.play(fault, seed + i))
            now = ending.name if ending else f'the end of {phase.name}'
            record.add(where, now, scene.end(ending))
        except AssertionError as error:
            record.broken.append(f'{where}: {now}: {error}')
            print(record.broken[-1], flush=True)
            for process in start.started:
                print(f'--- {process.name}: {process.popen.poll()}\n{process.said[-2000:]}')
        finally:
            start.close()
            probe.close()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--only', default='', help='a part of the name of a fault')
    parser.add_argument('--chapter', default='', help='a part of the heading of a table')
    parser.add_argument('--phase', default='', help='of one phase only')
    parser.add_argument('--page', type=Path, default=PAGE, help='the page to write')
    given = parser.parse_args()
    record = Record()
    faults = tuple(f for name, fs in CHAPTERS.items() for f in fs if given.chapter in name)
    whole = not (given.only or given.chapter or given.phase)
    if not any(given.only in fault.name for fault in faults):
        parser.error('--only, --chapter: no fault has such a name')
    if given.phase and given.phase not in {phase.name for phase in IN_EACH}:
        parser.error(f'--phase: not one of {", ".join(phase.name for phase in IN_EACH)}')
    for number in range(given.rounds):
        for phase in IN_EACH:
            chosen = [f for f in faults if phase in f.phases and given.only in f.name]
            chosen = [f for f in chosen if f not in ENDINGS]
            if chosen and given.phase in {'', phase.name}:
                where = f'round {number + 1}, {phase.name}'
                play(record, where, chosen, phase, None, 1000 * number)
        for ending in ENDINGS:
            if given.only in ending.name and not given.phase and ending in faults:
                play(record, f'round {number + 1}', (), Phase.CONTROL, ending, 0)
    if whole:
        page = write(given.page.read_text(encoding='utf-8'), record.outcomes, given.rounds)
        given.page.write_text(page, encoding='utf-8')
    print('\n'.join(record.broken) or 'everything held')
    return 1 if record.broken else 0


if __name__ == '__main__':
    sys.exit(main())
