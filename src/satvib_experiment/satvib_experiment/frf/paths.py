# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Secondary paths of a recorded run: from every voltage to every reading, beside the identified models and the rig."""

from itertools import pairwise

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.phases import Phase
from satvib_control.laws.strut_excitation import StrutSignals
from satvib_ident.frequency.averaged import averaged_responses
from satvib_ident.frequency.response import FrequencyResponse
from satvib_ident.frequency.settings import FrfSettings

from satvib_experiment.frf.curve import OPEN, PATH, Curve
from satvib_experiment.frf.exact import exact_paths, identified_model
from satvib_experiment.frf.how import Moved, estimate, heard, moved_by_excitation
from satvib_experiment.recording.recording import Recording
from satvib_experiment.recording.signals import without_bias

_SHORTEST = 256  # samples


def secondary_paths(
    recording: Recording, settings: FrfSettings, modelled: Recording | None = None
) -> list[Curve]:
    """Estimate from IDENTIFY: coils driven one after the other, or all at once by signals that differ.

    Args:
        recording: the run.
        settings: of the estimates; several coils at once are always H1.
        modelled: the run whose identified models are shown; None: this one.

    Returns:
        One curve for each pair of output and input; nothing for a run without an excitation that tells the coils
        apart.

    Raises:
        SatvibError: the turn of a coil is too short.
    """
    spans = [(s, e) for phase, s, e in recording.phases() if phase is Phase.IDENTIFY]
    if not spans or not recording.has('voltage', 'voltage'):
        return []
    window = recording.window(*spans[0])
    u = recording.get('voltage', 'voltage')[window].T
    y = without_bias(recording, window).T
    driven = np.isfinite(u) & (u != 0.0)
    if u.shape[-1] < _SHORTEST or not driven.any(axis=-1).all():
        return []
    turns = _turns(driven)
    columns = (
        _one_by_one(recording, u, y, turns, settings)
        if turns is not None
        else _together(u, y, recording.sample_period, settings)
    )
    model = identified_model(modelled or recording)
    found = []
    for j, column in enumerate(columns):
        exact = exact_paths(recording, column.frequency)
        for i, name in enumerate(recording.struts):
            own = model[i].frequency_response(column.frequency) if model and i == j else None
            truth = None if exact is None else exact[:, i, j]
            found.append(Curve(PATH, OPEN, name, recording.struts[j], column[i], truth, own))
    return found


def _turns(driven: Mask) -> list[slice] | None:
    """Stretch (n) in which each coil alone is driven; None where they are driven at the same time."""
    ends = [(int(np.argmax(d)), d.size - int(np.argmax(d[::-1]))) for d in driven]
    order = np.argsort([first for first, _ in ends])
    for before, after in pairwise(order):
        if ends[before][1] > ends[after][0]:
            return None
    return [slice(first, last) for first, last in ends]


def _one_by_one(
    recording: Recording, u: Array, y: Array, turns: list[slice], settings: FrfSettings
) -> list[FrequencyResponse]:
    dt = recording.sample_period
    moved = _excitation(recording)
    found = []
    for j, turn in enumerate(turns):
        # the first period is not steady yet
        first = moved[j].period if (turn.stop - turn.start) >= 4 * moved[j].period else 0
        part = slice(turn.start + first, turn.stop)
        found.append(estimate(u[j, part][None, :], y[:, part], dt, moved[j], settings))
    return found


def _excitation(recording: Recording) -> list[Moved]:
    """What each coil was driven by, as far as the scenario says it."""
    struts = len(recording.struts)
    if recording.scenario is None:
        return [Moved()] * struts
    p = recording.scenario.controller_parameters(1.0 / recording.sample_period, struts=struts)
    signals = StrutSignals(
        p.excitation, p.excitation_amplitude, p.excitation_frequencies, p, (struts,)
    )
    return [moved_by_excitation(signal) for signal in signals.signals]


def _together(u: Array, y: Array, dt: float, settings: FrfSettings) -> list[FrequencyResponse]:
    """Columns by H1 of all inputs; nothing where they cannot be told apart."""
    found = averaged_responses(u, y, dt, settings)
    known = np.isfinite(found.value).all(axis=(0, 1))
    low, high = heard(u, dt, settings)
    known &= (found.frequency >= low) & (found.frequency <= high)
    if known.sum() < 2:
        return []
    kept = found.at_lines(known)
    return [kept[:, j] for j in range(len(u))]


def coupling(curves: list[Curve], struts: tuple[str, ...]) -> tuple[list[float], Array] | None:
    """How strongly a coil moves the other struts, at the frequency where it moves its own most.

    Returns:
        That frequency of each coil (n), Hz, and the matrix (n, n) of |reading i per voltage j| over |reading j per
        voltage j|; None without paths.
    """
    paths = {(c.output, c.input): c.measured for c in curves if c.quantity == PATH}
    if not paths:
        return None
    at, matrix = [], np.full((len(struts), len(struts)), np.nan)
    for j, coil in enumerate(struts):
        own = paths[coil, coil]
        peak = int(np.nanargmax(np.where(own.coherence > 0.5, own.magnitude, 0.0)))
        at.append(float(own.frequency[peak]))
        for i, strut in enumerate(struts):
            with np.errstate(divide='ignore', invalid='ignore'):  # a sensor that shows nothing
                matrix[i, j] = paths[strut, coil].magnitude[peak] / own.magnitude[peak]
    return at, matrix
