# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which stretch of a run shows the vibration without control, and which under settled control."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.phases import Phase

from satvib_experiment.recording.recording import Recording

Span = tuple[float, float]

# of an automatic window's phase, the first part, which is left out while the vibration settles
_SETTLING = 0.4
_SILENT = (Phase.STANDBY, Phase.CALIBRATE)


@dataclass(frozen=True)
class Windows:
    """Windows in s since sample 0; None when the run has no such stretch."""

    uncontrolled: Span | None
    controlled: Span | None


def find_windows(recording: Recording, onset: float) -> Windows:
    """Take the windows of the scenario, and find from the phases what it leaves out.

    Args:
        recording: the run.
        onset: s, when the disturbance begins.

    Raises:
        SatvibError: a window lies outside of what was recorded; of a recording that was cut short, before it.
    """
    settings = recording.scenario.analysis if recording.scenario else None
    given = {
        name: tuple(getattr(settings, name)) if settings else ()
        for name in ('uncontrolled', 'controlled')
    }
    begin = float(recording.time[0])
    last = float(recording.time[-1]) + recording.sample_period
    for name, span in given.items():
        if span and span[0] >= last and not recording.is_cut:
            raise SatvibError(
                f'{recording.source}: ends at {last:.2f} s, before the {name} window at {span[0]} s'
            )
    uncontrolled = given['uncontrolled'] or _uncontrolled(recording, onset)
    controlled = given['controlled'] or _controlled(recording, onset)
    for name, window in (('uncontrolled', uncontrolled), ('controlled', controlled)):
        if window and window[1] <= begin:
            raise SatvibError(
                f'{recording.source}: begins at {begin:.2f} s, after the {name} window at '
                f'{window[0]:g} s'
            )
    return Windows(_cut(uncontrolled, begin, last), _cut(controlled, begin, last))


def _cut(span: tuple[float, ...] | None, begin: float, last: float) -> Span | None:
    return (max(span[0], begin), min(span[1], last)) if span and span[0] < last else None


def _uncontrolled(recording: Recording, onset: float) -> Span | None:
    best: Span | None = None
    for phase, start, end in recording.phases():
        if phase is Phase.CONTROL:
            break
        begin = max(start, onset)
        if phase in _SILENT and end > begin:
            best = (begin + _SETTLING * (end - begin), end)
    return best


def _controlled(recording: Recording, onset: float) -> Span | None:
    spans = [(s, e) for phase, s, e in recording.phases() if phase is Phase.CONTROL]
    if not spans or spans[-1][1] <= max(spans[-1][0], onset):
        return None
    start, end = max(spans[-1][0], onset), spans[-1][1]
    return start + (1.0 - _SETTLING) * (end - start), end
