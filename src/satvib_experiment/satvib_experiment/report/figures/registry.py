# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""All figures of a report, in the order of the page. To list them imports nothing of plotting."""

import importlib
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from satvib_experiment.report.context import Context

# module beside this one, whose name is also that of the file; heading
FIGURES = (
    ('attenuation', 'Attenuation at a glance'),
    ('acceleration', 'Acceleration with control off and on'),
    ('isolation', 'What an isolator is judged by'),
    ('spectra', 'Spectra'),
    ('spectrogram', 'Spectrogram'),
    ('line_of_sight', 'Line of sight'),
    ('parameters', 'Identified parameters'),
    ('model', 'Plant output and model output'),
    ('response', 'Models against the rig'),
    ('gains', 'Gains'),
    ('voltage', 'Voltages'),
)


@dataclass(frozen=True)
class Drawn:
    """One figure of the report."""

    name: str
    heading: str
    caption: str
    path: Path


def figure_module(name: str) -> ModuleType:
    """Import the module of a figure, with `CAPTION` and `draw`; one whose words depend on the run has `caption`."""
    return importlib.import_module(f'satvib_experiment.report.figures.{name}')


def draw_figure(context: Context, folder: Path, name: str) -> Drawn | None:
    """Draw a figure into `folder`; None when the run has nothing to show."""
    module = figure_module(name)
    path = folder / f'{name}.png'
    if not module.draw(context, path):
        return None
    caption = module.caption(context) if hasattr(module, 'caption') else module.CAPTION
    return Drawn(name, dict(FIGURES)[name], caption, path)
