# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is known of one strut while a graph runs: samples, levels, state, model, and their history."""

from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from satvib_common.levels import mean_of_known
from satvib_common.phases import Phase
from satvib_common.sequence import Arrival, SequenceTracker
from satvib_common.struts.applied import TEXTS, Applied
from satvib_experiment.analysis.levels import spectrum
from satvib_experiment.analysis.running_attenuation import RunningAttenuation

from satvib_bringup.watch.numbers import short
from satvib_bringup.watch.samples import Column, SampleRing

WINDOW = 10.0  # s, shown
BLOCKS = 500  # of the window
_KEPT = 12.0  # s
_SPECTRUM = 8.0  # s, length of the stretch behind a spectrum
_LATE = 0.05  # s, for the voltage of a sample to arrive
_HISTORY = 300  # looks at gains and parameters that are kept

# what is outside of these is no sample: a page must not end because of a message that is out of order
_MOST, _PERIODS = 2**53, (1e-5, 10.0)
_PHASES = {int(phase): phase for phase in Phase}
_TEXTS = {int(state): text for state, text in TEXTS.items()}
GAINS = ('kp', 'ki', 'kd', 'ki_min', 'ki_max')
PLATES = slice(Column.UPPER, Column.LOWER + 1)


class WatchedStrut:
    """One strut.

    Args:
        name: namespace of the strut, without the leading slash.

    Attributes:
        state: newest figures of the controller by name.
        model: newest figures of the identified model by name.
        applied: what became of the newest voltage, one of `Applied`.
        nodes: by what they write ('acceleration', 'voltage', 'identified_model'), full names of nodes.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.nodes: dict[str, list[str]] = {}
        self.runs = 0
        self._begin()

    def _begin(self) -> None:
        """Forget the run before."""
        self.runs += 1
        self.period = 0.0
        self.phase: Phase | None = None
        self.state: dict[str, Any] = {}
        self.model: dict[str, Any] = {}
        self.level = float('nan')
        self.applied = int(Applied.UNKNOWN)
        self._tracker = SequenceTracker()
        self._ring: SampleRing | None = None
        self._running: RunningAttenuation | None = None
        self._gains: deque[list[Any]] = deque(maxlen=_HISTORY)
        self._theta: deque[list[Any]] = deque(maxlen=_HISTORY)
        self._spectra: dict[str, Any] = {}
        self._shown = -1  # newest block that has been shown

    # ---- what comes from the graph

    def take_accelerations(self, rows: Sequence[tuple[int, float, float, float]]) -> None:
        """Take samples: sequence, sample period, upper, lower; from sample 0 on it is another run."""
        rows = [row for row in rows if row[0] < _MOST and _PERIODS[0] <= row[1] <= _PERIODS[1]]
        begin = 0
        for i, row in enumerate(rows):
            if self._tracker.classify(row[0]) is Arrival.RESTART:
                self._begin()
                self._tracker.classify(row[0])
                begin = i
        if not rows[begin:]:
            return
        if self._ring is None:
            self.period = rows[begin][1]
            self._ring = SampleRing(max(round(_KEPT / self.period), 2 * BLOCKS))
        table = np.array([row[2:] for row in rows[begin:]])
        self._ring.put(PLATES, np.array([row[0] for row in rows[begin:]]), table)

    def take_voltages(self, column: Column, rows: Sequence[tuple[int, float]]) -> None:
        """Take voltages: sequence, V. They belong to accelerations that have come before."""
        ring = self._ring
        rows = [row for row in rows if ring is not None and row[0] <= ring.head]
        if ring is None or not rows:
            return
        table = np.array([row[1:] for row in rows])
        ring.put(slice(column, column + 1), np.array([row[0] for row in rows]), table)

    def take_progress(self, sequence: int, phase: int, level: float) -> None:
        """Take how far the controller is: phase and running RMS of the upper acceleration in m/s^2."""
        self.phase, self.level = _phase(phase), level
        if self.period and self._running is None:
            # the schedule does not say when the disturbance begins: the last STANDBY counts
            self._running = RunningAttenuation(0.0, self.period, 1)
        if self._running is not None:
            self._running.add(sequence, phase, level)

    def take_state(self, figures: Mapping[str, Any]) -> None:
        """Take what the controller says: the fields of a ControllerState."""
        self.state = dict(figures)
        self.phase = _phase(figures['phase'])
        if self.period:
            time = figures['sequence'] * self.period
            self._gains.append([time, *(figures[name] for name in GAINS)])

    def take_model(self, figures: Mapping[str, Any]) -> None:
        """Take what the identifier says: the fields of an IirParameters, without the covariance."""
        self.model = dict(figures)
        theta = [*figures['a'], *figures['b']]
        time = figures['sequence'] * figures['sample_period']
        self._theta.append([time, theta, list(figures['standard_deviation'])])

    # ---- what goes to the page

    def look(self) -> None:
        """Do what is due every second: the spectra."""
        ring = self._ring
        if ring is None or ring.head < BLOCKS // 4:
            return
        count = round(_SPECTRUM / self.period)
        plates = np.stack([ring.newest(c, count) for c in (Column.UPPER, Column.LOWER)], axis=1)
        plates = np.where(np.isfinite(plates), plates, np.nan)
        # the mean of a sensor is its bias: a lost sample must not look like a step to zero
        plates = np.where(np.isnan(plates), mean_of_known(plates), plates)
        resolution = 4.0 / (len(plates) * self.period)
        frequency, density = spectrum(plates, self.period, resolution)
        found = {'frequency': frequency, 'upper': density[:, 0], 'lower': density[:, 1]}
        if self.phase is Phase.STANDBY:
            self._spectra['before'] = [frequency, density[:, 0]]
        self._spectra |= found

    @property
    def attenuation(self) -> float:
        """Attenuation so far in dB, negative is better; NaN outside of CONTROL."""
        return float(self._running.decibels[0]) if self._running is not None else float('nan')

    def news(self) -> dict[str, Any]:
        """What is new since the last call, with blocks that have been shown when a late voltage belongs to them."""
        first = self._shown + 1
        if self._ring is not None:
            first = min(first, max(self._ring.changed, 0) // self._size)
            self._ring.changed = self._ring.head + 1
        found = self._message(1) | {'blocks': self._blocks(first, None)}
        self._shown = found['blocks']['last']
        return found

    def whole(self) -> dict[str, Any]:
        """Everything up to the last `news`, for a page that has just been opened."""
        first = max(self._shown + 1 - BLOCKS, 0)
        return self._message(_HISTORY) | {'blocks': self._blocks(first, self._shown)}

    def _message(self, most: int) -> dict[str, Any]:
        spectra = {name: short(values) for name, values in self._spectra.items()}
        return {
            'name': self.name,
            'run': self.runs,
            'period': self.period,
            'phase': self.phase.name if self.phase is not None else '',
            'time': self._ring.head * self.period if self._ring is not None else None,
            'level': short(self.level),
            'attenuation': short(self.attenuation),
            'state': {name: short(value) for name, value in self.state.items()},
            'model': {name: short(value) for name, value in self.model.items()},
            # four digits of a time would not do: the curves of a long run need every instant
            'gains': [[round(t, 4), *short(more)] for t, *more in list(self._gains)[-most:]],
            'theta': [[round(t, 4), *short(more)] for t, *more in list(self._theta)[-most:]],
            'spectra': spectra,
            'applied': _TEXTS.get(self.applied, ''),
            'nodes': self.nodes,
        }

    @property
    def _size(self) -> int:
        """Samples in a block."""
        return max(round(WINDOW / self.period / BLOCKS), 1)

    def _blocks(self, first: int, last: int | None) -> dict[str, Any]:
        """Blocks from `first` to `last`, or to the newest whose voltages should be there."""
        ring = self._ring
        if ring is None:
            return {'first': 0, 'last': -1, 'size': 0, 'low': [], 'high': []}
        size = self._size
        if last is None:
            complete = ring.head + 1 - max(round(_LATE / self.period), 1)
            last = max(complete // size - 1, self._shown)
            first = max(first, last + 1 - BLOCKS)
        low, high = ring.blocks(first, last + 1, size)
        shown: dict[str, Any] = {'first': first, 'last': last, 'size': size}
        for name, values in (('low', low), ('high', high)):
            shown[name] = [short(column) for column in values]
        return shown


def _phase(number: int) -> Phase | None:
    return _PHASES.get(number)
