# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib node`: any node of the workspace, as `ros2 run` starts it."""

import os
from typing import Annotated, Any

import typer
from satvib_common.errors import SatvibError
from satvib_common.process.start import start_with_blocked_signals


def node(
    context: typer.Context,
    package: Annotated[
        str | None, typer.Argument(help='As in `ros2 run`.', metavar='PACKAGE')
    ] = None,
    executable: Annotated[str | None, typer.Argument(metavar='EXECUTABLE')] = None,
) -> None:
    """Start a node in this terminal; without arguments list the nodes.

    What follows goes to the node: `satvib node satvib_control strut_controller --ros-args -r __ns:=/strut_1`.
    """
    from satvib_bringup.live import workspace

    if package is None:
        _list()
        return
    known = workspace.executables()
    if package not in known:
        raise SatvibError(f'{package}: no such package here; there are {", ".join(sorted(known))}')
    if executable is None or executable not in known[package]:
        what = executable or 'EXECUTABLE is missing'
        raise SatvibError(f'{package}: {what}: it has {", ".join(sorted(known[package]))}')
    path = str(workspace.executable(package, executable))
    start_with_blocked_signals()
    os.execve(path, [path, *context.args], workspace.graph_environment())  # noqa: S606 - no shell


SETTINGS: dict[str, Any] = {
    'allow_extra_args': True,
    'ignore_unknown_options': True,
    'allow_interspersed_args': False,
}


def _list() -> None:
    from rich.table import Table

    from satvib_bringup.cli.console import make_console
    from satvib_bringup.live.workspace import executables

    table = Table(title='Nodes: satvib node PACKAGE EXECUTABLE')
    table.add_column('package')
    table.add_column('executable')
    for package, names in sorted(executables().items()):
        for name in sorted(names):
            table.add_row(package, name)
    make_console().print(table)
