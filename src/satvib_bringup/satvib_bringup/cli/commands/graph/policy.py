# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib policy`: the SROS2 policy of a scenario's graph."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from satvib_bringup.cli.options import ScenarioName, Settings


def policy(
    scenario: ScenarioName,
    settings: Settings = None,
    composition: Annotated[
        str,
        typer.Option('--composition', help='As of `satvib run`.', metavar='separate|strut|single'),
    ] = '',
    channels: Annotated[
        Path | None,
        typer.Option('--channels', help='On real hardware: the channels file.', metavar='FILE'),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            '--output', '-o', help='Where to. Without it: to the terminal.', metavar='FILE'
        ),
    ] = None,
) -> None:
    """Write who may publish, hear and call what in the graph of a scenario, for `ros2 security generate_artifacts`.

    Each process has an enclave with its name; docs/security.md says how it is used.
    """
    from satvib_common.errors import SatvibError
    from satvib_experiment.scenario.scenario import load_scenario

    from satvib_bringup.live.graph import graph_of, with_bridge
    from satvib_bringup.live.security.policy import policy_of

    # a bag that is never written: a recorder has its enclave too; in lockstep some nodes hear more
    bag, realtime = Path('bag'), channels is not None
    graph = graph_of(load_scenario(scenario, settings or []), realtime, bag, composition)
    if channels is not None:
        graph = with_bridge(graph, str(channels))
    text = policy_of(graph)
    if output is None:
        sys.stdout.write(text)
        return
    try:
        with output.open('x', encoding='utf-8') as file:
            file.write(text)
    except FileExistsError:
        raise SatvibError(f'{output}: exists already, not overwritten') from None
