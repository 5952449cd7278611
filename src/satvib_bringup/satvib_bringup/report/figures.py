# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""All figures of a report, in the order in which a reader wants them."""

from dataclasses import dataclass
from pathlib import Path

from satvib_bringup.report import (
    acceleration_figure,
    attenuation_figure,
    gains_figure,
    model_figure,
    parameters_figure,
    response_figure,
    spectra_figure,
    voltage_figure,
)
from satvib_bringup.report.context import Context

# name of the file, heading, module
FIGURES = (
    ('attenuation', 'Attenuation at a glance', attenuation_figure),
    ('acceleration', 'Acceleration with control off and on', acceleration_figure),
    ('spectra', 'Spectra', spectra_figure),
    ('parameters', 'Identified parameters', parameters_figure),
    ('model', 'Plant output and model output', model_figure),
    ('response', 'Models against the rig', response_figure),
    ('gains', 'Gains', gains_figure),
    ('voltage', 'Voltages', voltage_figure),
)


@dataclass(frozen=True)
class Drawn:
    """One figure of the report."""

    name: str
    heading: str
    caption: str
    path: Path


def draw_figures(context: Context, folder: Path) -> list[Drawn]:
    """Draw into `folder` every figure that the run has something to show for."""
    drawn = []
    for name, heading, module in FIGURES:
        path = folder / f'{name}.png'
        if module.draw(context, path):
            drawn.append(Drawn(name, heading, module.CAPTION, path))
    return drawn
