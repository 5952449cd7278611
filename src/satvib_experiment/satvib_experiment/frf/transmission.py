# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Transmissibility of a recorded run, payload over base: strut by strut and motion by motion, open and closed loop."""

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_ident.frequency.settings import FrfSettings

from satvib_experiment.analysis.tones import disturbance_onset
from satvib_experiment.analysis.windows import Span, find_windows
from satvib_experiment.frf.curve import OPEN, TRANSMISSIBILITY, Curve
from satvib_experiment.frf.exact import exact_plates
from satvib_experiment.frf.how import Moved, estimate, moved_by
from satvib_experiment.frf.modes import named_motions
from satvib_experiment.recording.recording import Recording

BASE = 'base'


def transmissibilities(
    recording: Recording, settings: FrfSettings, period: float | None = None
) -> list[Curve]:
    """Estimate from the stretches of a run without and under control.

    Args:
        recording: the run.
        settings: of the estimates.
        period: s, after which what moves the base repeats; None: as the scenario says.

    Returns:
        One curve for each loop and strut, and for each motion of the payload where the rig is known. Nothing for a
        run whose base does not move, or whose lower plates were not measured.

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
            moved = Moved(moved.low, moved.high, round(period / dt))
        found += _curves(recording, span, closed, moved, settings)
    return found


def _curves(
    recording: Recording, span: Span, closed: bool, moved: Moved, settings: FrfSettings
) -> list[Curve]:
    window = recording.window(*span)
    upper = recording.get('acceleration', 'upper')[window].T
    lower = recording.get('acceleration', 'lower')[window].T
    if not np.isfinite(upper).any() or not np.isfinite(lower).any():
        return []
    dt = recording.sample_period
    loop = law_name(recording) if closed else OPEN
    measured = estimate(lower, upper, dt, moved, settings)
    exact = exact_plates(recording, measured.frequency, closed)
    curves = [
        Curve(TRANSMISSIBILITY, loop, name, BASE, measured[i], _ratio(exact, i))
        for i, name in enumerate(recording.struts)
    ]
    names, matrix = named_motions(recording.rig)
    if len(names) < 2:
        return curves
    heave = names.index('heave') if 'heave' in names else 0
    motions, base = _times(matrix, upper), _times(matrix[heave : heave + 1], lower)
    measured = estimate(base, motions, dt, moved, settings)
    for m, name in enumerate(names):
        truth = None
        if exact is not None:
            truth = (exact[0] @ matrix[m]) / (exact[1] @ matrix[heave])
        curves.append(Curve(TRANSMISSIBILITY, loop, name, BASE, measured[m], truth))
    return curves


def _times(matrix: Array, signals: Array) -> Array:
    """The product, by sums that keep a NaN in its own sample."""
    return np.asarray(np.einsum('mn,nt->mt', matrix, signals))


def _ratio(plates: tuple[Complex, Complex] | None, i: int) -> Complex | None:
    return None if plates is None else np.asarray(plates[0][:, i] / plates[1][:, i])


def law_name(recording: Recording) -> str:
    """Name of the law that acts in CONTROL."""
    if recording.scenario is not None:
        central = recording.scenario.scheme == 'centralized'
        return 'centralized' if central else str(recording.scenario.controller.get('law', 'closed'))
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
