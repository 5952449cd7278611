# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What commands show: live progress, the final table, plain lines where there is no terminal."""

import math
import time
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text
from satvib_common.errors import printable
from satvib_common.phases import Phase

# s of wall time; a fast run has few lines then, and its table is not buried
_LOG_EVERY = 5.0
# exit code of a run that has a report, and is no result
NO_RESULT = 3
_KINDS = ('measured_rms', 'true_rms', 'measured_tone', 'true_tone')


class _Console(Console):
    """Shows texts as they are: no markup, no emoji codes, control characters as escapes."""

    def render_str(self, text: str, **style: Any) -> Text:
        lines = '\n'.join(map(printable, text.split('\n')))
        return super().render_str(lines, **{**style, 'markup': False, 'emoji': False})


def make_console() -> Console:
    """Give the console on standard output, wide enough for the tables in a log."""
    console = _Console(highlight=False)
    return console if console.is_terminal else _Console(highlight=False, width=110)


def decibels(value: float | None) -> str:
    """Show an attenuation; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return '–'
    return f'{value:+.1f}'


class ProgressView:
    """Phase, time and attenuation per strut while a run goes on; a context manager.

    Args:
        console: where to.
        end: s, length of the run.
        title: what runs.
        every: s of wall time between two lines where there is no terminal; beside those that begin a phase.
    """

    def __init__(self, console: Console, end: float, title: str, every: float = _LOG_EVERY) -> None:
        self._console, self._end, self._title, self._every = console, end, title, every
        self._live = console.is_terminal
        self._progress = Progress(
            TextColumn('{task.description}', style='bold', markup=False),
            BarColumn(bar_width=24),
            TextColumn('{task.fields[status]}', markup=False),
            TimeElapsedColumn(),
            console=console,
            transient=True,
        )
        self._task = self._progress.add_task(title, total=end, status='')
        self._phase: Phase | None = None
        self._logged = -math.inf
        self._started = time.monotonic()

    def __enter__(self) -> Self:
        """Begin to show."""
        if self._live:
            self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, _: TracebackType | None
    ) -> None:
        """End it."""
        if self._live:
            self._progress.stop()

    def update(self, phase: Phase, now: float, attenuation: Iterable[float]) -> None:
        """Show where the run stands; `now` in s of the run, attenuation in dB per strut."""
        status = f'{phase.name:<9} {now:6.2f} of {self._end:g} s'
        values = [float(a) for a in attenuation]
        if any(map(math.isfinite, values)) and phase is Phase.CONTROL:
            status += '   ' + ' / '.join(decibels(a) for a in values) + ' dB'
        if self._live:
            self._progress.update(self._task, completed=now, status=status)
        elif phase is not self._phase or self.elapsed >= self._logged + self._every:
            self._console.print(f'{self._title}: {status}')
            self._logged = self.elapsed
        self._phase = phase

    @property
    def elapsed(self) -> float:
        """Wall time since the view was made, s."""
        return time.monotonic() - self._started


def result_table(result: dict[str, Any]) -> Table:
    """Give the table of attenuations of a run, from what result.json holds."""
    struts = result['struts']
    kinds = _kinds(result)
    compared = any(s['reference'] is not None for s in struts)
    name = result['scenario'] or 'Unknown scenario'
    table = Table(title=f'{name}: attenuation in dB, negative is better')
    table.add_column('strut')
    for kind in kinds:
        table.add_column(kind.replace('_', '\n'), justify='right', style=_style(kind))
    table.add_column('noise\nfloor rms', justify='right')
    table.add_column('noise\nfloor tone', justify='right')
    if compared:
        table.add_column('to\ncompare', justify='right')
    table.add_column('largest\nvoltage', justify='right')
    for strut in struts:
        cells = [strut['name']]
        cells += [decibels(strut['attenuation'][kind]) for kind in kinds]
        floor = strut['noise_floor']
        cells += [decibels(floor['measured_rms']), decibels(floor['measured_tone'])]
        if compared:
            cells.append(decibels(strut['reference']))
        volts = strut['largest_voltage']
        cells.append('–' if volts is None else f'{volts:.1f} V')
        table.add_row(*cells)
    return table


def _kinds(result: dict[str, Any]) -> list[str]:
    """The attenuations that are known of any strut."""
    return [k for k in _KINDS if any(s['attenuation'][k] is not None for s in result['struts'])]


def _style(kind: str) -> str | None:
    return 'bold' if kind.startswith('true') else None


def show_shortfalls(console: Console, result: dict[str, Any]) -> None:
    """Print what makes a run worthless."""
    for line in result['shortfalls']:
        console.print(f'THIS RUN IS NO RESULT: {line}', style='bold red')


def show_result(console: Console, result: dict[str, Any]) -> None:
    """Print the table of a run and what must be known about it.

    What makes the run worthless comes first. A run without any attenuation has no table.
    """
    show_shortfalls(console, result)
    if _kinds(result):
        console.print(result_table(result))
        if result['reference_source']:
            console.print(f'to compare: {result["reference_source"]}', style='dim')
    if sentence := line_of_sight(result):
        console.print(f'• {sentence}')
    for note in result['notes']:
        console.print(f'• {note}')


def line_of_sight(result: dict[str, Any]) -> str:
    """Say how far the payload tilts; '' where it is not known."""
    from satvib_experiment.analysis.line_of_sight import ARC_SECONDS

    sights = result['line_of_sight']
    shown = [
        f'{ARC_SECONDS * sights[name]["true"]:.3g}" {words}'
        for name, words in (
            ('uncontrolled', 'without control'),
            ('controlled', 'under control'),
            ('open_loop', 'its open-loop twin in the same instants'),
        )
        if sights[name] and sights[name]['true'] is not None
    ]
    if not shown:
        return ''
    return f'line of sight, true, RMS above {sights["above"]:g} Hz: {", ".join(shown)}'


def comparison_table(result: dict[str, Any]) -> Table:
    """Give the table of the runs beside one another, from what result.json holds."""
    from satvib_experiment.report.comparison import HOLDS, OF_THE_PAPER

    table = Table(title='attenuation of the worst strut in dB, negative is better')
    table.add_column('law')
    table.add_column('samples and output')
    for name in ('tone\nmeasured', 'tone\ntrue', 'rms\ntrue'):
        table.add_column(name, justify='right', style=_style(name[-4:]))
    table.add_column('the paper', justify='right')
    for row in result['comparison']:
        paper = row['paper']
        table.add_row(
            f"{row['law']}, the paper's" if row['law'] == OF_THE_PAPER else row['law'],
            f'{row["rate"]:g} Hz, {HOLDS[row["hold"]]}',
            *(decibels(value) for value in row['attenuation'].values()),
            f'{paper[0]:.1f} to {paper[1]:.1f}' if paper else '',
        )
    return table


def show_comparison(console: Console, result: dict[str, Any]) -> None:
    """Print the runs beside one another, what must be known, and why they differ."""
    from satvib_experiment.report.comparison import WHY

    show_shortfalls(console, result)
    for note in result['notes']:
        console.print(f'• {note}')
    console.print(comparison_table(result))
    console.print(WHY)


def show_page(console: Console, page: Path) -> None:
    """Print where the report is."""
    console.print(f'report: {page}', soft_wrap=True)
