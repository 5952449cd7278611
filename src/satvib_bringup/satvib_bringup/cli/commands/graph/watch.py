# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib watch`: a local web page of a running graph."""

import sys
import webbrowser
from pathlib import Path
from typing import Annotated

import typer
from satvib_common.errors import SatvibError

Port = Annotated[
    int | None,
    typer.Option(
        '--port',
        help='Port of this machine; 0: any that is free. Without it: 8421, or another when that is in use.',
        min=0,
        max=65535,
        show_default=False,
    ),
]


def watch(
    port: Port = None,
    browser: Annotated[
        bool, typer.Option('--browser/--no-browser', help='Open the page in a browser.')
    ] = False,
    folder: Annotated[
        Path, typer.Option('--folder', help='Where recordings from the page go.')
    ] = Path('runs'),
) -> None:
    """Show a running graph as a web page on this machine, whoever started it, in any namespace of this domain.

    Accelerations, voltages, gains, models, spectra, attenuation and faults of every strut; stop, reset, arm, record,
    and the parameters that can change while nodes run. Ctrl-C ends it; the graph does not notice.
    """
    try:
        from satvib_bringup.watch.live.process import watch as serve
    except ModuleNotFoundError as error:
        raise SatvibError(
            f'the module {error.name} is not there: watching needs the built workspace; start it as '
            './satvib, or source install/setup.bash first'
        ) from None

    def ready(address: str) -> None:
        sys.stdout.write(f'{address}\n')
        sys.stdout.flush()
        if browser:
            webbrowser.open(address)

    serve(port, folder, ready)
