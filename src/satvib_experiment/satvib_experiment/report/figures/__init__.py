# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a report: one file per figure, listed in `registry`."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.report.figures.registry import FIGURES, Drawn, draw_figure

__all__ = [
    'FIGURES',
    'Drawn',
    'draw_figure',
]
__getattr__, __dir__ = door(__name__, __file__)
