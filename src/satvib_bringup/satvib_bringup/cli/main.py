# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The `satvib` command: one file per subcommand in `commands`, the errors told in one place.

Exit codes: 0 all is well, 1 a run failed, 2 the input or the set-up is wrong, 130 interrupted.
"""

import sys

import typer
from satvib_common.errors import RunError, SatvibError

from satvib_bringup.cli.commands import (
    campaign,
    compare,
    identify,
    listing,
    report,
    run,
    simulate,
    study,
    table,
    tune,
)

app = typer.Typer(
    name='satvib',
    help='Adaptive vibration isolation as a ROS 2 node graph: run it, simulate it, identify, report.',
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode='markdown',
)
app.command('demo')(run.demo)
app.command('run')(run.run)
app.command('simulate')(simulate.simulate)
app.command('report')(report.report)
app.command('identify')(identify.identify)
app.command('study')(study.study)
app.command('table')(table.table)
app.command('campaign')(campaign.campaign)
app.command('tune')(tune.tune)
app.command('compare')(compare.compare)
app.command('scenarios')(listing.scenarios)
app.command('rigs')(listing.rigs)


def main() -> None:
    """Run the command and turn its errors into one line and an exit code."""
    try:
        app(prog_name='satvib')
    except SatvibError as error:
        print(f'satvib: {error}', file=sys.stderr)  # noqa: T201 - a message for the terminal
        sys.exit(2)
    except RunError as error:
        print(f'satvib: {error}', file=sys.stderr)  # noqa: T201
        sys.exit(1)
    except KeyboardInterrupt:
        print('satvib: interrupted', file=sys.stderr)  # noqa: T201
        sys.exit(130)


if __name__ == '__main__':
    main()
