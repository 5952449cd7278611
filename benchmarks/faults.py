# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Plays every fault of the fault suite on a running graph, several times, and writes the tables of docs/faults.md.

    ./satvib shell -c 'python benchmarks/faults.py --rounds 5'

The faults, what must happen and the limits are in tests/faults/faults.py. Exit code 1: something did not hold.
"""

import argparse
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / 'tests'), str(ROOT / 'tests' / 'faults')]

from faults import ENDINGS, GOES_ON  # noqa: E402 - they live with the tests
from play import Scene  # noqa: E402
from processes import Probe, Starter, own_domain  # noqa: E402
from table import write  # noqa: E402

PAGE = ROOT / 'docs' / 'faults.md'


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--only', default='', help='a part of the name of a fault')
    parser.add_argument('--page', type=Path, default=PAGE, help='the page to write')
    given = parser.parse_args()
    outcomes, broken = defaultdict(list), []
    chosen = [fault for fault in GOES_ON if given.only in fault.name]
    for number in range(given.rounds):
        with tempfile.TemporaryDirectory() as name, own_domain(Path(name)):
            start, probe = Starter(Path(name), quiet=True), Probe()
            try:
                scene = Scene(start, probe)
                for i, fault in enumerate(chosen):
                    outcome = scene.play(fault, len(chosen) * number + i)
                    outcomes[fault.name].append(outcome)
                    print(f'round {number + 1}: {fault.name}: {outcome}', flush=True)
                    broken += [f'{fault.name}: {text}' for text in outcome.broken]
                ending = ENDINGS[number % len(ENDINGS)]
                outcome = scene.end(ending)
                outcomes[ending.name].append(outcome)
                broken += [f'{ending.name}: {text}' for text in outcome.broken]
            finally:
                start.close()
                probe.close()
    if not given.only:
        page = write(given.page.read_text(encoding='utf-8'), outcomes, given.rounds)
        given.page.write_text(page, encoding='utf-8')
    for text in broken:
        print(text)
    return 1 if broken else 0


if __name__ == '__main__':
    sys.exit(main())
