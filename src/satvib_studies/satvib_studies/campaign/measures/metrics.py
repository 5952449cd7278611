# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a campaign keeps of every trial: a row of figures, made while the loop runs.

`TrialMetrics` takes the steps of a `ClosedLoop` of any batch shape; the figures of a trial have the same bits in every
batch. Definitions are those of `analysis.evaluate`, except that there is no open-loop twin: attenuations compare with
the window before control.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array, Integers
from satvib_common.levels import decibel
from satvib_common.phases import Phase
from satvib_control.laws.reasons import text_of
from satvib_experiment.analysis.tones import disturbance_onset, disturbance_tones
from satvib_experiment.analysis.windows import find_windows
from satvib_experiment.recording.recording import Recording

from satvib_studies.campaign.measures.metrics_kernel import (
    add_sample,
    fingerprint,
    rms_level,
    tone_level,
)

if TYPE_CHECKING:
    from satvib_experiment.twin.closed_loop import ClosedLoop
    from satvib_experiment.twin.step import LoopStep


_SOURCES = ('true', 'measured')
WINDOWS = ('uncontrolled', 'controlled')
_LARGEST = {'stroke_peak': 'stroke_peak', 'force_peak': 'force_peak'}
_GAINS = ('kp', 'ki', 'kd')


class TrialMetrics:
    """Figures of all trials of a loop.

    Args:
        loop: before its first step. Shape () counts as one trial.

    A trial needs about 2 kB, and 1 kB more per tone beyond the first.
    """

    def __init__(self, loop: ClosedLoop) -> None:
        self._loop = loop
        trials, struts = len(loop.scenarios), loop.plant.struts
        self._dt = loop.plant.dt
        self._windows = np.zeros((trials, 2, 2))
        tones: list[list[float]] = []
        sequence = np.arange(loop.plan.end)
        for i, scenario in enumerate(loop.scenarios):
            disturbance = scenario.make_disturbance()
            frequencies = scenario.analysis.frequencies or disturbance_tones(disturbance)
            tones.append([f for f in frequencies if f < 0.5 / self._dt])
            outline = Recording(
                (), self._dt, loop.plan, sequence, sequence, {}, scenario, source=scenario.name
            )
            found = find_windows(outline, disturbance_onset(disturbance))
            for j, span in enumerate((found.uncontrolled, found.controlled)):
                if span is not None:
                    window = outline.window(*span)
                    self._windows[i, j] = window.start, window.stop
        most = max(max(map(len, tones)), 1)
        self._tones = np.array([row + [np.nan] * (most - len(row)) for row in tones])
        self._sums = np.zeros((trials, 2, 2, struts, 2 + 2 * most))
        self._gram = np.zeros((trials, 2, 2, 2 * most + 1, 2 * most + 1))
        self._origin = np.full((trials, 2, struts), np.nan)
        self._span = (self._windows[:, :, 0].min(), self._windows[:, :, 1].max())
        self._shape = (trials, struts)
        self._voltage = np.zeros(self._shape)
        self._saturated = np.zeros(self._shape)
        self._control = 0
        self._largest = {name: np.zeros(self._shape) for name in _LARGEST}
        self._digest = np.full(trials, 14695981039346656037, dtype=np.uint64)
        self._last: LoopStep | None = None

    def add(self, step: LoopStep) -> None:
        """Take the next sample."""
        shape = self._shape
        voltage = step.output.voltage.reshape(shape)
        self._voltage = np.maximum(self._voltage, np.abs(voltage))
        self._digest = fingerprint(voltage.view(np.uint64), self._digest)
        if step.phase is Phase.CONTROL:
            self._control += 1
            self._saturated = self._saturated + step.output.saturated.reshape(shape)
        for name in _LARGEST:
            value = getattr(step.truth, name).reshape(shape)
            self._largest[name] = np.fmax(self._largest[name], value)
        if self._span[0] <= step.sequence < self._span[1]:
            fine = step.truth.upper
            add_sample(
                float(step.sequence),
                self._dt,
                self._windows,
                self._tones,
                fine.reshape(*shape, fine.shape[-1]),
                step.sample.upper.reshape(shape),
                self._origin,
                self._sums,
                self._gram,
            )
        self._last = step

    def levels(self, kind: str, window: str) -> Array:
        """Give the level of a kind ('true_rms', 'measured_tone', ...) in a window (trials, struts), m/s^2."""
        source, _, what = kind.partition('_')
        s, w = _SOURCES.index(source), WINDOWS.index(window)
        kernel = rms_level if what == 'rms' else tone_level
        level: Array = kernel(
            self._tones[:, None], self._sums[:, w, s], self._gram[:, w, s][:, None]
        )
        return level

    def columns(self) -> dict[str, NDArray[Any]]:
        """Give the figures by column, (trials) each: per strut with its number, and the worst strut.

        'attenuation_*' in dB, levels in m/s^2, voltages in V, strokes in m, forces in N.
        """
        if self._last is None:
            return {}
        table: dict[str, NDArray[Any]] = {}
        for kind in ('true_rms', 'true_tone', 'measured_rms', 'measured_tone'):
            before, under = (self.levels(kind, window) for window in WINDOWS)
            ratio = decibel(under, before)
            # np.max hands a NaN on: a strut without a figure is not a good one
            table[f'attenuation_{kind}'] = ratio.max(axis=1)
            _spread(table, f'attenuation_{kind}', ratio)
            _spread(table, f'level_{kind}', under)
        table['voltage_peak'] = self._voltage.max(axis=1)
        _spread(table, 'voltage_peak', self._voltage)
        share = self._saturated / max(self._control, 1)
        table['saturated_share'] = share.max(axis=1)
        for name, value in self._largest.items():
            table[name] = value.max(axis=1)
        output, identification = self._last.output, self._last.identification
        fault = output.fault.reshape(self._shape)
        table['faults'] = fault.sum(axis=1)
        table['trusted'] = identification.converged.reshape(self._shape).sum(axis=1)
        for name in _GAINS:
            gain = np.asarray(getattr(output.state, name))
            _spread(table, name, gain.reshape(self._shape))
        codes = np.broadcast_to(output.reason, output.fault.shape).reshape(self._shape)
        table['reason'] = np.array([_told(row) for row in codes], dtype=object)
        table['fingerprint'] = self._digest
        return table


def _spread(table: dict[str, NDArray[Any]], name: str, values: Array) -> None:
    for i in range(values.shape[1]):
        table[f'{name}_{i + 1}'] = np.ascontiguousarray(values[:, i])


def _told(codes: Integers) -> str:
    """What the struts say at the end, each text once."""
    return '; '.join(dict.fromkeys(text_of(code) for code in codes if code))
