# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A long run, in real time and in lockstep: what is lost or late, and what grows. Writes the figures of docs/soak.md.

    ./satvib shell -c 'python benchmarks/soak.py'                      # an hour of each
    ./satvib shell -c 'python benchmarks/soak.py --minutes 3'
    ./satvib shell -c 'python benchmarks/soak.py --kind lockstep --composition single --no-page'

In real time the minutes are those of the clock. In lockstep they are the same number of samples, as fast as it goes.
Exit code 1: something is lost, descriptors have grown, or shared memory is used.
"""

import argparse
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / 'tests'), str(ROOT / 'tests' / 'soak')]

from processes import own_domain  # noqa: E402 - they live with the tests
from soak_page import KINDS, text_of, write  # noqa: E402
from soaking import Soak, soak  # noqa: E402

PAGE = ROOT / 'docs' / 'soak.md'
_READINGS = 720  # of a run


def complaints(found: Soak) -> list[str]:
    """What must not be."""
    outcome = found.outcome
    wrong = [] if outcome['success'] else [outcome['message']]
    if outcome['lost']:
        wrong.append(f'{outcome["lost"]} samples and voltages are lost')
    for name, growth in found.processes.items():
        first, last = growth.first, growth.last
        if last.descriptors > first.descriptors:
            wrong.append(f'{name}: {first.descriptors} descriptors, {last.descriptors} in the end')
        if last.shared:
            wrong.append(f'{name}: {last.shared} files in shared memory')
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--minutes', type=float, default=60.0, help='of the experiment')
    parser.add_argument('--kind', choices=[*KINDS.values(), 'both'], default='both')
    parser.add_argument('--scenario', default='soft_3dof')
    parser.add_argument('--rate', type=float, default=200.0, help='Hz')
    parser.add_argument('--composition', default='separate')
    parser.add_argument('--set', nargs='+', default=[], dest='more', help='changes to the scenario')
    parser.add_argument('--page', type=Path, default=PAGE, help='the page to write')
    parser.add_argument('--no-page', action='store_true', help='show the figures only')
    given = parser.parse_args()
    settings = [
        f'duration={60.0 * given.minutes}', f'rig.acquisition.sample_rate={given.rate}', 'analysis={}',
        *given.more,
    ]  # fmt: skip
    wrong = []
    for realtime, kind in KINDS.items():
        if given.kind not in {kind, 'both'}:
            continue
        with tempfile.TemporaryDirectory(prefix='satvib-soak-') as place, own_domain(Path(place)):
            every = max(round(given.minutes * 60.0 * given.rate / _READINGS), 1)
            found = soak(
                given.scenario, settings, Path(place, 'soak'), realtime, given.composition, every
            )
        text = text_of(found, given.minutes, given.scenario, given.composition)
        print(f'{kind}: {text}', flush=True)
        wrong += [f'{kind}: {complaint}' for complaint in complaints(found)]
        if not given.no_page:
            page = given.page.read_text(encoding='utf-8')
            given.page.write_text(write(page, realtime, text), encoding='utf-8')
    print('\n'.join(wrong) or 'nothing is lost, and no descriptor is left')
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main())
