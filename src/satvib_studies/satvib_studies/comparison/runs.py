# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The runs of a comparison: one batch of the offline twin per scheme, all cases and seeds at once, judged in truth.

Level: RMS of the payload's modes (w and the tilts at the struts' circle, or the motions of a payload on listed struts)
together, from the fine grid. Attenuation:
against the same rig, seed and case at 0 V, in the same window.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_experiment.scenario.centralized_scheme import geometry_of
from satvib_experiment.twin.closed_loop import ClosedLoop
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.comparison.cases import OPEN, Comparison, drawn_rig

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class ComparisonResult:
    """What became of a comparison.

    Attributes:
        comparison: what was compared.
        dt: s.
        level: by scheme and 'open': (cases, seeds, samples) mean square of all modes in each period, (m/s^2)^2.
        tilt: likewise, of the tilts alone.
        voltage: by scheme: (cases, seeds) largest voltage, V.
    """

    comparison: Comparison
    dt: float
    level: dict[str, Array]
    tilt: dict[str, Array]
    voltage: dict[str, Array]

    def window(self, name: str) -> slice:
        """Samples of a window."""
        start, stop = self.comparison.windows[name]
        return slice(round(start / self.dt), round(stop / self.dt))

    def attenuation(self, scheme: str, case: str, window: str) -> Array:
        """Give it in dB, seed by seed (seeds,)."""
        i, w = list(self.comparison.cases).index(case), self.window(window)
        mine, open_ = (self.level[s][i, :, w].mean(axis=-1) for s in (scheme, OPEN))
        return np.asarray(10.0 * np.log10(mine / open_))

    def tilt_rms(self, scheme: str, case: str, window: str) -> Array:
        """Give the RMS of the tilts (seeds,), m/s^2 at the struts' circle; `scheme` may be 'open'."""
        i, w = list(self.comparison.cases).index(case), self.window(window)
        return np.asarray(np.sqrt(self.tilt[scheme][i, :, w].mean(axis=-1)))


def run_comparison(comparison: Comparison, progress: Progress | None = None) -> ComparisonResult:
    """Run every scheme in every case with every seed.

    Args:
        comparison: what to run.
        progress: called with scheme, sample and samples.

    Raises:
        SatvibError: a rig without a geometry.
    """
    level: dict[str, Array] = {}
    tilt: dict[str, Array] = {}
    voltage: dict[str, Array] = {}
    shape = (len(comparison.cases), comparison.seeds)
    dt = math.nan
    for scheme in (OPEN, *comparison.schemes):
        scenarios = [
            comparison.scenario(scheme, case, comparison.seed + i)
            for case in comparison.cases
            for i in range(comparison.seeds)
        ]
        rigs: list[Any] = []
        for scenario in scenarios:
            rig = scenario.load_rig()
            geometry_of(rig, f'comparison {comparison.name}')
            if not isinstance(rig, Rig) or not payload_modes(rig).tilts:
                raise SatvibError(
                    f'comparison {comparison.name}: the payload of {rig.name} does not tilt; three or more struts are '
                    'needed'
                )
            modes = payload_modes(rig)
            rigs.append(drawn_rig(rig, scenario.seed))
        loop = ClosedLoop(scenarios, rigs)
        dt, mode, tilts = loop.plant.dt, modes.mode, list(modes.tilts)
        squares = np.zeros((2, len(scenarios), loop.plan.end))
        largest = np.zeros(len(scenarios))
        for step in loop.steps():
            q = np.einsum('mi,tif->tmf', mode, step.truth.upper)
            power = np.mean(q * q, axis=2)
            squares[:, :, step.sequence] = power.sum(axis=1), power[:, tilts].sum(axis=1)
            largest = np.maximum(largest, np.max(np.abs(step.output.voltage), axis=1))
            if progress is not None and step.sequence % 100 == 0:
                progress(scheme, step.sequence, loop.plan.end)
        level[scheme] = squares[0].reshape(*shape, -1)
        tilt[scheme] = squares[1].reshape(*shape, -1)
        voltage[scheme] = largest.reshape(shape)
    return ComparisonResult(comparison, dt, level, tilt, voltage)
