# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib topics`: list, rate and echo of the topics of a running graph, without the `ros2` command."""

from typing import Annotated

import typer

app = typer.Typer(
    help='Topics of a running graph: list them, how fast they are, what they say.',
    invoke_without_command=True,
    add_completion=False,
    rich_markup_mode=None,
)


@app.callback()
def topics(
    context: typer.Context,
    everything: Annotated[
        bool, typer.Option('--all', help='Topics of other programs too.')
    ] = False,
) -> None:
    """List the topics with their writers and readers."""
    if context.invoked_subcommand:
        return
    from rich.table import Table

    from satvib_bringup.cli.console import make_console
    from satvib_bringup.live.topics.listener import Listener

    table = Table(title='Topics')
    for heading in ('topic', 'message', 'written by', 'read by'):
        table.add_column(heading)
    with Listener() as listener:
        rows = listener.topics(everything=everything)
    for row in rows:
        kind = row.kind.replace('/msg/', '/')
        table.add_row(row.name, kind, '\n'.join(row.writers), '\n'.join(row.readers))
    make_console().print(table if rows else _nothing())


@app.command()
def rate(
    names: Annotated[
        list[str] | None, typer.Argument(help='Without one: all that are written.', metavar='TOPIC')
    ] = None,
    seconds: Annotated[float, typer.Option(help='How long to listen.', min=0.1)] = 3.0,
) -> None:
    """Measure how many messages a second the topics have."""
    from rich.table import Table

    from satvib_bringup.cli.console import make_console
    from satvib_bringup.live.topics.listener import Listener

    table = Table(title=f'Rates over {seconds:g} s')
    for heading in ('topic', 'messages', 'Hz', 'longest gap in ms', 'kB/s'):
        table.add_column(heading, justify='left' if heading == 'topic' else 'right')
    with Listener() as listener:
        found = listener.rates(names or [], seconds)
    for name, r in found.items():
        table.add_row(
            name, str(r.messages), f'{r.hertz:.1f}', f'{1e3 * r.longest:.1f}', f'{r.size / seconds / 1e3:.1f}'
        )  # fmt: skip
    make_console().print(table if found else _nothing())


@app.command()
def echo(
    name: Annotated[str, typer.Argument(metavar='TOPIC')],
    count: Annotated[int, typer.Option(help='End after so many; 0: go on.', min=0)] = 0,
    patience: Annotated[
        float, typer.Option(help='Seconds to wait for the next one; 0: for ever.', min=0.0)
    ] = 0.0,
) -> None:
    """Print the messages of a topic, phases by name."""
    from satvib_bringup.live.topics.listener import Listener
    from satvib_bringup.live.topics.readable import text_of

    with Listener() as listener:
        for message in listener.messages(name, count, patience):
            typer.echo(f'{text_of(message)}\n---')


def _nothing() -> str:
    import os

    domain = os.environ.get('ROS_DOMAIN_ID', '0')
    return f'No satvib graph is running in domain {domain}.'
