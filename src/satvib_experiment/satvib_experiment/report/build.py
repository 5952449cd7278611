# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Writes the report of a run into a folder: figures/*.png, report.html, result.json."""

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError

from satvib_experiment.analysis.analysis import analyse
from satvib_experiment.analysis.evaluation import Evaluation
from satvib_experiment.recording.recording import Recording
from satvib_experiment.report.comparison import Row, row_of
from satvib_experiment.report.context import Context
from satvib_experiment.report.drawing import Drawing
from satvib_experiment.report.page import write_page
from satvib_experiment.report.result import write_result


@dataclass(frozen=True)
class Report:
    """A written report.

    Attributes:
        page: report.html.
        result: what result.json holds.
        evaluation: the figures.
    """

    page: Path
    result: dict[str, Any]
    evaluation: Evaluation


def refuse_existing(folder: Path) -> None:
    """Refuse a folder that holds a report already.

    Raises:
        SatvibError: naming the file that would be overwritten.
    """
    for name in ('report.html', 'result.json', 'figures'):
        if (folder / name).exists():
            raise SatvibError(
                f'{folder / name}: exists already, not overwritten; choose another folder'
            )


def write_report(
    recording: Recording,
    folder: Path,
    drawing: Drawing | None = None,
    analysed: Callable[[dict[str, Any]], None] | None = None,
    beside: Callable[[], list[Row]] | None = None,
) -> Report:
    """Analyse a run and write its report.

    Args:
        recording: the run.
        folder: where to; made when it is not there.
        drawing: who draws; None: processes that start now.
        analysed: called with what result.json holds, before the figures are drawn.
        beside: gives the runs that are shown beside this one.

    Raises:
        SatvibError: there is a report already, the folder cannot be written, or the run is too short.
    """
    refuse_existing(folder)
    page = folder / 'report.html'
    with contextlib.nullcontext(drawing) if drawing else Drawing() as hands:
        evaluation, open_loop = analyse(recording)
        rows: tuple[Row, ...] = ()
        if beside is not None and recording.scenario is not None:
            rows = (row_of(recording.scenario, evaluation), *beside())
        context = Context(recording, open_loop, evaluation, rows)
        figures = folder / 'figures'
        try:
            figures.mkdir(parents=True)
        except OSError as error:
            raise SatvibError(f'{figures}: cannot be made: {error.strerror}') from None
        result = write_result(context, folder / 'result.json')
        if analysed is not None:
            analysed(result)
        try:
            drawn = hands.draw(context, figures)
        except OSError as error:
            raise SatvibError(f'{figures}: cannot be written: {error.strerror}') from None
        write_page(context, result, drawn, page)
    return Report(page, result, evaluation)
