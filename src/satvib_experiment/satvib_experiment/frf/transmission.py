# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Transmissibility of a recorded run, payload over base: strut by strut and motion by motion, open and closed loop."""

from collections.abc import Sequence

import numpy as np
from satvib_common.arrays import Array, Complex, Mask
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_ident.frequency.settings import FrfSettings
from satvib_plant_sim.rig.rig import Rig

from satvib_experiment.analysis.tones import disturbance_onset
from satvib_experiment.analysis.windows import Span, find_windows
from satvib_experiment.frf.curve import BASE, HEAVE, OPEN, TRANSMISSIBILITY, Curve
from satvib_experiment.frf.exact import base_direction, exact_plates
from satvib_experiment.frf.how import (
    Moved,
    base_directions,
    estimate,
    moved_by,
    period_samples,
)
from satvib_experiment.frf.merit import merit_of
from satvib_experiment.frf.modes import along, named_motions
from satvib_experiment.recording.recording import Recording

Direction = tuple[float, ...]
_PURE = 1.0 - 1e-6  # share of one motion from which the base moves in that one alone
_NARROW = 0.1  # of a peak's frequency: width of a mode with a damping ratio of 5 %
_LEAST = 1e-3  # share of the largest power up to which the base does not move there


def transmissibilities(
    recording: Recording, settings: FrfSettings, period: float | None = None
) -> list[Curve]:
    """Estimate from the stretches of a run without and under control.

    Args:
        recording: the run.
        settings: of the estimates.
        period: s, after which what moves the base repeats; None: as the scenario says.

    Returns:
        One curve for each loop and strut, and for each motion of the payload where the rig is known. Where the base
        moves in several directions at once, a motion is over the same motion of the base, and nothing exact is known.
        Nothing for a run whose base does not move, or whose lower plates were not measured.

    Raises:
        SatvibError: a stretch is too short.
    """
    if not recording.has('acceleration', 'lower'):
        return []
    scenario = recording.scenario
    disturbance = scenario.make_disturbance() if scenario else None
    if disturbance is not None and not any(p.target == 'base' for p in disturbance.parts()):
        return []
    onset = disturbance_onset(disturbance) if disturbance else 0.0
    windows = find_windows(recording, onset)
    found = []
    for span, closed in ((windows.uncontrolled, False), (windows.controlled, True)):
        if span is None:
            continue
        dt = recording.sample_period
        moved = moved_by(disturbance, *span, dt) if disturbance else Moved()
        if period is not None:
            moved = Moved(moved.low, moved.high, period_samples(period, dt))
        found += _curves(recording, span, closed, moved, settings)
    return found


def _curves(
    recording: Recording,
    span: Span,
    closed: bool,
    moved: Moved,
    settings: FrfSettings,
) -> list[Curve]:
    window = recording.window(*span)
    upper = recording.get('acceleration', 'upper')[window].T
    lower = recording.get('acceleration', 'lower')[window].T
    if not np.isfinite(upper).any() or not np.isfinite(lower).any():
        return []
    dt = recording.sample_period
    loop = law_name(recording) if closed else OPEN
    one, _ = base_direction(recording, [span])

    def exact(frequency: Array) -> tuple[Complex, Complex] | None:
        return None if one is None else exact_plates(recording, frequency, closed, one)

    measured = estimate(lower, upper, dt, moved, settings)
    plates = exact(measured.frequency)
    moves = _moves(lower)  # a foot that moves across its strut alone gives nothing to divide by
    curves = [
        Curve(TRANSMISSIBILITY, loop, name, BASE, measured[i], _ratio(plates, i))
        for i, name in enumerate(recording.struts)
        if moves[i]
    ]
    names, matrix = named_motions(recording.rig)
    if len(names) < 2:
        return curves
    if one is None:
        return curves + _own_motions(loop, names, matrix, lower, upper, dt, moved, settings)
    assert isinstance(recording.rig, Rig)
    base = along(recording.rig, one) @ matrix
    measured = estimate(_times(base[None], lower), _times(matrix, upper), dt, moved, settings)
    plates = exact(measured.frequency)
    for m, name in enumerate(names):
        truth = None if plates is None else (plates[0] @ matrix[m]) / (plates[1] @ base)
        moving = _input(recording.rig, one)
        curves.append(
            Curve(TRANSMISSIBILITY, loop, name, moving, measured[m], truth, is_motion=True)
        )
    return curves


def _input(rig: Rig, direction: Direction) -> str:
    """Name the motion of the base: 'base' where it heaves, 'base_x' and so on along one motion, else its factors."""
    names, _ = named_motions(rig)
    share = along(rig, direction)
    name = names[int(np.argmax(np.abs(share)))]
    if np.max(np.abs(share)) < _PURE:
        return f'base along {" ".join(f"{v:.2g}" for v in direction)}'
    return BASE if name == HEAVE else f'{BASE}_{name}'


def _moves(signals: Array) -> Mask:
    """Which of (m, t) have more than a thousandth of the largest power."""
    power = np.nanvar(signals, axis=1)
    return np.asarray(power > _LEAST * np.nanmax(power))


def _own_motions(
    loop: str, names: tuple[str, ...], matrix: Array, lower: Array, upper: Array, dt: float,
    moved: Moved, settings: FrfSettings,
) -> list[Curve]:  # fmt: skip
    """Each motion of the payload over the same motion of the base, where the base has it."""
    base = _times(matrix, lower)
    found = []
    for m in np.flatnonzero(_moves(base)):
        measured = estimate(base[m], _times(matrix[m : m + 1], upper)[0], dt, moved, settings)
        name = names[m]
        found.append(
            Curve(TRANSMISSIBILITY, loop, name, f'{BASE}_{name}', measured, is_motion=True)
        )
    return found


def _times(matrix: Array, signals: Array) -> Array:
    """The product, by sums that keep a NaN in its own sample."""
    return np.asarray(np.einsum('mn,nt->mt', matrix, signals))


def _ratio(plates: tuple[Complex, Complex] | None, i: int) -> Complex | None:
    return None if plates is None else np.asarray(plates[0][:, i] / plates[1][:, i])


def law_name(recording: Recording) -> str:
    """Name of the law that acts in CONTROL."""
    if recording.scenario is not None:
        return recording.law or 'closed'
    return 'closed' if recording.plan.first_of(Phase.CONTROL) is not None else OPEN


def check_moved(curves: list[Curve], recording: Recording) -> None:
    """Refuse a run from which no frequency response can be estimated.

    Raises:
        SatvibError: there is no curve.
    """
    if not curves:
        raise SatvibError(
            f'{recording.source}: no stretch in which the base moves or a coil is driven; what measures is written by '
            '`satvib frf SCENARIO`'
        )


def resolution_notes(curves: Sequence[Curve]) -> list[str]:
    """Say where the lines are too far apart for the peaks that they show."""
    coarse = []
    for curve in curves:
        merit = merit_of(curve.measured) if curve.quantity == TRANSMISSIBILITY else None
        if merit is None or curve.measured.frequency.size < 2:
            continue
        spacing = float(np.min(np.diff(curve.measured.frequency)))
        if spacing > _NARROW * merit.peak_frequency:
            coarse.append(spacing)
    if not coarse:
        return []
    text = (
        f'lines are {max(coarse):.2g} Hz apart, too far for the peaks: peak and roll-off are rough; a longer stretch '
        'helps, or fewer --averages'
    )
    return [text]


def direction_notes(recording: Recording) -> list[str]:
    """Say what must be known of a base that moves in several directions at once."""
    scenario = recording.scenario
    if scenario is None or not isinstance(recording.rig, Rig) or not recording.rig.struts.each:
        return []
    found = base_directions(scenario.make_disturbance(), 0.0, scenario.duration)
    if len(found) < 2:
        return []
    text = (
        f'the base moves in {len(found)} directions at once: a strut shows their mixture, a motion is over the same '
        'motion of the base, and lines of low coherence say nothing; `satvib frf SCENARIO --direction` moves one at a '
        'time'
    )
    return [text]
