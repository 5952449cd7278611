# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The `satvib` command: one file per subcommand in `commands`, their errors in one place.

Exit codes: 0 all is well, 1 a run failed, 2 the input or the set-up is wrong, 3 a model
that should not be used (`identify`) or a run that is no result, 70 a defect of satvib, 130 interrupted.
"""

import sys

import typer
from satvib_common.errors import RunError, SatvibError
from satvib_common.files.disk import disk_complaint

from satvib_bringup.cli.commands import (
    bench,
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
from satvib_bringup.cli.commands.graph import call, node, policy, topics, watch
from satvib_bringup.cli.commands.isolator import frf, judge
from satvib_bringup.cli.last_resort import EXIT_CODE, is_switched_off, last_resort, show

app = typer.Typer(
    name='satvib',
    help='Adaptive vibration isolation as a ROS 2 node graph: run it, simulate it, identify, report.',
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # rich help takes three times as long to start
)
app.command('demo', short_help="The paper's experiment as a live graph.")(run.demo)
app.command('run', short_help='Run a scenario as a live graph; record and report.')(run.run)
app.command('simulate', short_help='Run a scenario in this process.')(simulate.simulate)
app.command('report', short_help='Report a recorded run.')(report.report)
app.command('identify', short_help='Identify a model of a record.')(identify.identify)
app.command('frf', short_help='Measure frequency responses.')(frf.frf)
app.command('judge', short_help='Judge laws as isolators.')(judge.judge)
app.command('study', short_help="Which signal identifies the paper's model.")(study.study)
app.command('table', short_help='Laws on rigs under disturbances, as tables.')(table.table)
app.command('campaign', short_help='Run thousands of drawn trials.')(campaign.campaign)
app.command('tune', short_help='Find gains of the centralized law.')(tune.tune)
app.command('compare', short_help='Compare control schemes.')(compare.compare)
app.command('bench', short_help='How fast the live graph is on this machine.')(bench.bench)
app.command('node', short_help='Start any node.', context_settings=node.SETTINGS)(node.node)
app.add_typer(topics.app, name='topics', short_help='Topics of a running graph: list, rate, echo.')
app.command('call', short_help='Call a service of a running graph: reset, stop, arm.')(call.call)
app.command('policy', short_help="The SROS2 policy of a scenario's graph.")(policy.policy)
app.command('watch', short_help='A local web page of a running graph.')(watch.watch)
app.command('scenarios')(listing.scenarios)
app.command('rigs')(listing.rigs)


def main() -> None:
    """Run the command and turn its errors into one line and an exit code."""
    try:
        app(prog_name='satvib')
    except SatvibError as error:
        show(str(error))
        sys.exit(2)
    except RunError as error:
        show(str(error))
        sys.exit(1)
    except KeyboardInterrupt:
        show('interrupted')
        sys.exit(130)
    except Exception as error:
        if isinstance(error, OSError) and (complaint := disk_complaint(error)):
            show(complaint)
            sys.exit(2)
        if is_switched_off():
            raise
        show(last_resort(error, sys.argv[1:]))
        sys.exit(EXIT_CODE)


if __name__ == '__main__':
    main()
