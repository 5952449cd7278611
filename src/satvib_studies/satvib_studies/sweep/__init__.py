# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Sweeps: scenarios varied along named axes, every combination a run of the offline twin."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.sweep.sweep import Cell, Sweep, load_sweep, run_sweep, sweep_names
    from satvib_studies.sweep.tables import fill, markdown, plain_markdown, summary

__all__ = [
    'Cell',
    'Sweep',
    'fill',
    'load_sweep',
    'markdown',
    'plain_markdown',
    'run_sweep',
    'summary',
    'sweep_names',
]
__getattr__, __dir__ = door(__name__, __file__)
