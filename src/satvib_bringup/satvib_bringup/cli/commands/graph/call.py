# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib call`: a service of a running graph, without the `ros2` command."""

from typing import Annotated

import typer
from satvib_common.errors import printable


def call(
    service: Annotated[str, typer.Argument(help='Its name: NODE/reset.', metavar='SERVICE')],
    timeout: Annotated[
        float, typer.Option(help='Seconds within which the node must answer.', min=0.1)
    ] = 10.0,
) -> None:
    """Call a service of a node: reset, stop, arm, or another one of type std_srvs/Trigger.

    A node that does not answer is asked again after 5 s. Exit code 1: the node refuses; 2: there is no such service, or
    no answer.

    \b
    satvib call /strut_1/strut_controller/reset
    satvib call /daq_bridge/arm --timeout 30
    """  # noqa: D301 - the mark of lines that stay as they are
    from satvib_bringup.live.services.caller import Caller

    with Caller() as caller:
        well, text = caller.trigger(service, timeout)
    typer.echo(f'{"success" if well else "refused"}: {printable(text)}')
    if not well:
        raise typer.Exit(1)
