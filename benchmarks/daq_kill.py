# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How long the terminals hold a voltage after SIGKILL: real processes, real DDS, the emulator's terminals.

    ./satvib shell -c 'python benchmarks/daq_kill.py --times 20 --rate 200'

Each part is killed while voltages leave, --times times; the time runs from the signal to 0 V at the emulated device's
terminals. With --priority all processes of the stand ask for SCHED_FIFO.
"""

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / 'tests' / 'daq'))

from stand import Stand  # noqa: E402 - it lives with the tests

VICTIMS = {
    'bridge': ('bridge',),
    'guardian': ('guardian',),
    'controller': ('answerer_1',),
    'everything': ('guardian', 'bridge', 'answerer_1', 'answerer_2'),
}


def measure(
    stand: Stand, victims: tuple[str, ...], rate: float, timeout: float
) -> tuple[float, str]:
    """One kill; gives ms and who put the outputs to 0 V."""
    if 'bridge' not in stand.children:
        stand.states.clear()
        stand.start_bridge(
            wait_for_schedule=False, sample_rate=rate, command_timeout=timeout
        )  # fmt: skip
        stand.until_state('IDLE')
    if 'answerer_1' not in stand.children or 'answerer_2' not in stand.children:
        for name in ('answerer_1', 'answerer_2'):
            if name in stand.children:
                stand.kill(name)
                stand.children.pop(name).wait()
        stand.start_answerers()
    while True:
        if stand.state == 'FAULT':
            stand.call('reset')
            stand.until_state('IDLE')
        stand.hurry()
        stand.drive()
        turns = iter(range(len(stand.events()) % 7 + 3))
        stand.until(lambda t=turns: next(t, None) is None, 'a moment that is not always the same')
        if stand.events()[-1]['event'] == 'enabled':
            break
    moment = stand.kill(*victims)
    after, why = stand.zero_after(moment)
    for name in victims:
        if name in stand.children:
            stand.children.pop(name).wait()
    if 'bridge' not in victims:
        stand.until_state('FAULT')
    return after * 1e3, why


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--times', type=int, default=20)
    parser.add_argument('--rate', type=float, default=200.0)
    parser.add_argument('--timeout', type=float, default=0.0, help='command_timeout, s; 0: default')
    parser.add_argument('--priority', type=int, default=0)
    parser.add_argument('--only', choices=VICTIMS, action='append')
    given = parser.parse_args()
    os.environ.setdefault('ROS_DOMAIN_ID', '93')
    figures = {}
    with tempfile.TemporaryDirectory() as folder:
        # a killed controller counts as a publisher until its lease ends: make that short
        profiles = (ROOT / 'src/satvib_common/satvib_common/transport/closed.xml').read_text()
        quick = Path(folder, 'profiles.xml')
        quick.write_text(profiles.replace('<leaseDuration><sec>20<', '<leaseDuration><sec>2<'))
        os.environ['FASTRTPS_DEFAULT_PROFILES_FILE'] = str(quick)
        stand = Stand(Path(folder), given.priority)
        try:
            stand.write_channels()
            stand.start_emulator()
            for name in given.only or VICTIMS:
                found = [
                    measure(stand, VICTIMS[name], given.rate, given.timeout)
                    for _ in range(given.times)
                ]
                times = [ms for ms, _ in found]
                figures[name] = {
                    'times': len(times), 'median_ms': float(np.median(times)), 'worst_ms': max(times),
                    'by': sorted({why for _, why in found}),
                }  # fmt: skip
                print(f'{name}: {json.dumps(figures[name])}', flush=True)
        finally:
            stand.close()
    return 0


if __name__ == '__main__':
    sys.exit(main())
