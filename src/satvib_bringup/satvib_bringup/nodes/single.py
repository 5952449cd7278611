# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""All nodes of a scenario in one process, for launch files and `ros2 run`.

    ros2 run satvib_bringup single quick_3dof --set seed=7 --bag my_bag

`satvib run --composition single` is the same and makes the report too.
"""

import argparse
import sys
import threading
from pathlib import Path

from satvib_common.errors import RunError, SatvibError
from satvib_common.transport.reach import set_transport
from satvib_experiment.scenario.scenario import load_scenario

from satvib_bringup.live.graph import graph_of
from satvib_bringup.live.run import interruptible
from satvib_bringup.live.single import SingleRun


def main() -> None:
    """Run the graph; exit codes are those of any node."""
    parser = argparse.ArgumentParser(prog='single', description=(__doc__ or '').splitlines()[0])
    parser.add_argument('scenario')
    parser.add_argument('--set', action='append', default=[], metavar='KEY=VALUE')
    parser.add_argument('--realtime', action='store_true')
    parser.add_argument('--bag', type=Path)
    # what launch adds is for nodes that are alone in their process
    given, _ = parser.parse_known_args()
    interrupted = threading.Event()
    try:
        scenario = load_scenario(given.scenario, given.set)
        graph = graph_of(scenario, given.realtime, given.bag, 'single')
        set_transport()
        with SingleRun(graph) as run, interruptible(interrupted):
            run.start()
            run.run(interrupted, None)
    except (SatvibError, RunError) as error:
        if interrupted.is_set():  # the end that was asked for, as of any node
            return
        sys.stderr.write(f'single: {error}\n')
        sys.exit(2 if isinstance(error, SatvibError) else getattr(error, 'code', 1))


if __name__ == '__main__':
    main()
