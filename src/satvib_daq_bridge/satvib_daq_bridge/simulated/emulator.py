# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The command `daq_emulator`: the serial protocol on a pseudo-terminal, with a simulated rig behind it.

    daq_emulator --rig paper_3dof --link /tmp/satvib0

It does what the firmware does (`simulated.device`), with a clock of its own, and moves a plant by the voltages at its
terminals. The rig's sample rate and hold become those of the session. The plant rests until the outputs are first
enabled in a session; then the disturbance's time begins.

`--log` writes when the outputs were enabled and when they went to 0 V, and why, in seconds of the monotonic clock;
`--truth` saves at the end what the plant really did.
"""

import argparse
import os
import signal
import sys
import tty
from pathlib import Path
from types import FrameType

from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import parse_yaml
from satvib_common.settings_text import parse_settings
from satvib_plant_sim.rig.rig import load_rig

from satvib_daq_bridge.simulated.emulated_board import EmulatedBoard


def open_terminal(link: Path | None) -> tuple[int, int, str]:
    """Make a pseudo-terminal; gives the device's end, the host's end (kept open) and the host's path.

    Raises:
        SatvibError: the link exists already.
    """
    master, slave = os.openpty()
    tty.setraw(slave)
    os.set_blocking(master, False)
    path = os.ttyname(slave)
    if link is not None:
        try:
            link.symlink_to(path)
        except OSError as error:
            raise SatvibError(f'{link}: cannot be made: {error.strerror}') from None
        path = str(link)
    return master, slave, path


def main(arguments: list[str] | None = None) -> int:
    """Run an emulator until SIGTERM or SIGINT."""
    parser = argparse.ArgumentParser(prog='daq_emulator', description=__doc__.splitlines()[0])
    parser.add_argument(
        '--rig', default='paper_3dof', help='name of a rig, or the path of its file'
    )
    parser.add_argument(
        '--set', action='append', default=[], metavar='KEY=VALUE', help='change the rig'
    )
    parser.add_argument('--disturbance', default='kind: none', help='as in a scenario, as YAML')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--link', type=Path, help='path of the port, a link to the pseudo-terminal')
    parser.add_argument('--log', type=Path, help='write when outputs were enabled and zeroed')
    parser.add_argument('--truth', type=Path, help='save what the plant really did (.npz)')
    given = parser.parse_args(arguments)
    over = False

    def end(_: int, __: FrameType | None) -> None:
        nonlocal over
        over = True

    signal.signal(signal.SIGTERM, end)
    signal.signal(signal.SIGINT, end)
    try:
        rig = load_rig(given.rig, parse_settings(given.set, '--set'))
        disturbance = parse_yaml(given.disturbance, '--disturbance')
        log = os.open(given.log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC) if given.log else -1
        master, _, path = open_terminal(given.link)
        board = EmulatedBoard(rig, disturbance, given.seed, master, log, given.truth is not None)
    except (SatvibError, ValueError, OSError) as error:
        sys.stderr.write(f'daq_emulator: {error}\n')
        return 2
    sys.stdout.write(f'ready {path}\n')
    sys.stdout.flush()
    while not over:
        board.run_once()
    if given.truth:
        board.save(given.truth)
    if given.link:
        given.link.unlink(missing_ok=True)
    return 0


if __name__ == '__main__':
    sys.exit(main())
