# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib bench`: how fast the live graph is on this machine, against a bare graph of the same shape."""

from pathlib import Path
from typing import Annotated

import typer


def bench(
    whole: Annotated[
        bool,
        typer.Option('--whole', help='1, 3 and 6 struts, 100 to 1000 Hz; takes an hour or two.'),
    ] = False,
    rounds: Annotated[
        int,
        typer.Option('--rounds', help='How often each graph runs; 0: 1, or 5 with --whole.', min=0),
    ] = 0,
    only: Annotated[
        list[str] | None,
        typer.Option(
            '--only',
            help="Keep the cases whose name holds this, as in '3 struts, 200 Hz'; may be given many times.",
        ),
    ] = None,
    seconds: Annotated[
        float,
        typer.Option(
            '--seconds', help='Length of the runs in real time; 0: 6, or 60 with --whole.'
        ),
    ] = 0.0,
    file: Annotated[
        Path, typer.Option('--json', help='File for all figures; it is replaced.')
    ] = Path('bench.json'),
    page: Annotated[
        Path | None,
        typer.Option('--page', help='Write the tables into this Markdown page, too.'),
    ] = None,
    mark: Annotated[
        str, typer.Option('--mark', help='Where: between <!-- bench MARK --> and <!-- end -->.')
    ] = 'after',
) -> None:
    """Run a bare rclpy graph and satvib in turns, and compare speed, latency, processor time, start and memory.

    The bare graph has the same processes, topics, messages and quality of service, and no mathematics.
    """
    import json
    from dataclasses import replace

    from rich.table import Table
    from satvib_common.errors import SatvibError
    from satvib_studies.sweep.tables import fill

    from satvib_bringup.cli.console import make_console
    from satvib_bringup.live.bench.case import quick_cases, whole_cases
    from satvib_bringup.live.bench.run import bench as measure
    from satvib_bringup.live.bench.table import markdown, rows

    cases = whole_cases() if whole else quick_cases()
    if only:
        cases = [case for case in cases if any(text in case.name for text in only)]
    if not cases:
        raise SatvibError(f'--only {" ".join(only or [])}: no case is left')
    if seconds > 0.0:
        cases = [replace(case, seconds=seconds) if case.realtime else case for case in cases]
    console = make_console()
    found = measure(
        cases, rounds or (5 if whole else 1), lambda text: console.print(text, style='dim')
    )
    file.write_text(json.dumps(found, indent=1) + '\n', encoding='utf-8')
    for case in found['cases']:
        head, body = rows(case)
        table = Table(title=case['name'])
        for heading in head:
            table.add_column(heading, justify='left' if heading == 'graph' else 'right')
        for row in body:
            table.add_row(*row)
        console.print(table)
        for name, graph in case['graphs'].items():
            for text in graph['failed']:
                console.print(f'{name}: {text}')
    if page is not None:
        fill(page, {f'bench {mark}': markdown(found)})
    console.print(f'all figures: {file}')
