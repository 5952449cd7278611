# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib study`: the paper's simulation study of identification signals (its Figs. 3-5)."""

from satvib_bringup.cli.options import Folder, Settings


def study(settings: Settings = None, folder: Folder = None) -> None:
    """Which signal identifies the paper's model: every signal, with and without noise and disturbance, many seeds.

    Prints the table and draws the figures; `--set seeds=20`, `--set estimator=instrumental` and so on change it.
    """
    from rich.table import Table
    from satvib_common.settings_text import change_settings
    from satvib_experiment.recording.run_folder import free_run_folder, make_run_folder
    from satvib_studies.signal_study.plots import save_figures
    from satvib_studies.signal_study.study import StudySettings, run
    from satvib_studies.sweep.tables import plain_markdown

    from satvib_bringup.cli.console import make_console

    data: dict[str, object] = {}
    change_settings(data, settings or [])
    chosen = StudySettings.from_mapping(data, 'study')
    target = free_run_folder('study', folder)
    make_run_folder(target)
    console = make_console()
    with console.status('study') as status:
        result = run(chosen, lambda text: status.update(f'study: {text}'))
        save_figures(result, target)
    rows = result.table()
    table = Table(title=f'errors over {chosen.seeds} seeds from seed {chosen.seed}')
    for heading in result.HEADINGS:
        table.add_column(heading, justify='right')
    for row in rows:
        table.add_row(*row, end_section=row[1] == rows[-1][1])
    console.print(table)
    text = plain_markdown(result.HEADINGS, rows)
    (target / 'study.md').write_text(text, encoding='utf-8')
    console.print(f'the table and the figures are in {target}', soft_wrap=True)
