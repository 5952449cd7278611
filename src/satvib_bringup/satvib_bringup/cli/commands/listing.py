# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib scenarios` and `satvib rigs`: what comes with the package."""


def scenarios() -> None:
    """List the scenarios that come with satvib."""
    from rich.table import Table
    from satvib_experiment.scenario.folder import listed_scenarios

    from satvib_bringup.cli.console import make_console

    table = Table(title='Scenarios')
    for heading in ('name', 'rig', 'law', 'length', 'what it shows'):
        table.add_column(heading)
    for found in listed_scenarios():
        length = f'{found.duration:g} s'
        table.add_row(found.name, found.rig, found.law, length, found.description)
    make_console().print(table)


def rigs() -> None:
    """List the rigs that come with satvib."""
    from rich.table import Table
    from satvib_plant_sim.rig.rig import load_rig, rig_names

    from satvib_bringup.cli.console import make_console

    table = Table(title='Rigs')
    for heading in ('name', 'struts', 'sample rate', 'hold', 'what it is'):
        table.add_column(heading)
    for name in rig_names():
        rig = load_rig(name)
        acquisition = rig.acquisition
        table.add_row(
            name,
            str(rig.struts.count),
            f'{acquisition.sample_rate:g} Hz',
            acquisition.hold,
            rig.description,
        )
    make_console().print(table)
