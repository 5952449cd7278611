# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""All figures of a report, in the order of the page."""

from dataclasses import dataclass
from pathlib import Path

from satvib_experiment.report.context import Context
from satvib_experiment.report.figures import (
    acceleration,
    attenuation,
    gains,
    model,
    parameters,
    response,
    spectra,
    voltage,
)

# name of the file, heading, module
FIGURES = (
    ('attenuation', 'Attenuation at a glance', attenuation),
    ('acceleration', 'Acceleration with control off and on', acceleration),
    ('spectra', 'Spectra', spectra),
    ('parameters', 'Identified parameters', parameters),
    ('model', 'Plant output and model output', model),
    ('response', 'Models against the rig', response),
    ('gains', 'Gains', gains),
    ('voltage', 'Voltages', voltage),
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
