# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an isolator is judged by in a report: amplification, line of sight, criteria for vibration."""

import math
from dataclasses import asdict
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_ident.frequency.periodic import stepped_response
from satvib_ident.frequency.response import FrequencyResponse
from satvib_ident.frequency.settings import FrfSettings

from satvib_experiment.analysis.bands import (
    integrated,
    met_criterion,
    power_lines,
    third_octaves,
)
from satvib_experiment.analysis.line_of_sight import ARC_SECONDS, line_of_sight
from satvib_experiment.analysis.windows import Span
from satvib_experiment.frf.curve import OPEN, Curve
from satvib_experiment.frf.merit import merit_of
from satvib_experiment.frf.transmission import transmissibilities
from satvib_experiment.recording.recording import Recording
from satvib_experiment.recording.signals import fine, without_bias
from satvib_experiment.report.context import Context

_WORSE = 1.05  # times the tilt without control; two stretches of one vibration differ by less

WINDOWS = ('uncontrolled', 'controlled', 'open_loop')


def stretch(context: Context, name: str) -> tuple[Recording, Span] | None:
    """Give the recording and the span in s of 'uncontrolled', 'controlled' or 'open_loop'; None without one.

    An open loop in which nothing moves is none.
    """
    windows = context.evaluation.windows
    if name == 'open_loop':
        twin = context.open_loop
        if twin is None or windows.controlled is None or context.evaluation.at_rest.all():
            return None
        return twin, windows.controlled
    span = getattr(windows, name)
    return (context.recording, span) if span else None


def payload_signal(recording: Recording, span: Span) -> tuple[Array, float]:
    """Give the upper accelerations (t, struts) and their spacing in s: the truth where there is truth."""
    window = recording.window(*span)
    if recording.has('truth', 'upper'):
        return fine(recording, window), recording.fine_period
    return without_bias(recording, window), recording.sample_period


def octaves(context: Context, name: str) -> tuple[Array, Array] | None:
    """Give third octaves (b,) in Hz and the RMS velocity (b, struts) in m/s of a stretch; None without one."""
    found = stretch(context, name)
    if found is None:
        return None
    signal, dt = payload_signal(*found)
    frequency, power = power_lines(signal, dt)
    centres, velocity = third_octaves(frequency, integrated(frequency, power))
    return (centres, velocity) if centres.size else None


def tone_transmissibility(context: Context, name: str) -> FrequencyResponse | None:
    """Give upper over lower acceleration at the tones of a run (struts, tones); None without tones or a stretch."""
    found, tones = stretch(context, name), context.evaluation.frequencies
    if found is None or not tones or not found[0].has('acceleration', 'lower'):
        return None
    recording, window = found[0], found[0].window(*found[1])
    upper, lower = (recording.get('acceleration', plate)[window].T for plate in ('upper', 'lower'))
    if not (np.isfinite(upper).all() and np.isfinite(lower).all()):
        return None
    steps = [(f, 0, upper.shape[-1]) for f in tones]
    try:
        return stepped_response(lower, upper, recording.sample_period, steps)
    except SatvibError:  # shorter than a few periods
        return None


def broadband_curves(context: Context) -> list[Curve]:
    """Give the transmissibility of every strut by frequency, for a base that moves at many; nothing for tones."""
    scenario = context.recording.scenario
    if context.evaluation.frequencies or scenario is None or not scenario.disturbance:
        return []
    try:
        found = transmissibilities(context.recording, FrfSettings())
    except SatvibError:  # a stretch is too short
        return []
    return [curve for curve in found if curve.output in context.struts]


def judged(context: Context) -> dict[str, Any]:
    """Give the figures as plain data; what is not known is None."""
    above = _above(context)
    sights: dict[str, Any] = {}
    criteria: dict[str, Any] = {}
    amplification: dict[str, Any] = {}
    curves = broadband_curves(context)
    for name in WINDOWS:
        found = stretch(context, name)
        sight = line_of_sight(*found, above) if found else None
        sights[name] = asdict(sight) if sight else None
        bands = octaves(context, name)
        criteria[name] = (
            [met_criterion(bands[0], velocity) or None for velocity in bands[1].T]
            if bands
            else None
        )
        tones = tone_transmissibility(context, name)
        shown: list[FrequencyResponse | None] = []
        if tones is not None:
            shown = [tones[i] for i in range(len(context.struts))]
        if curves and name != 'open_loop':
            # a strut whose foot does not move along it has none
            own = {
                c.output: c.measured for c in curves if (c.loop == OPEN) == (name == 'uncontrolled')
            }
            shown = [own.get(strut) for strut in context.struts] if own else []
        amplification[name] = [_worst(response) for response in shown] or None
    return {
        'line_of_sight': {'above': above, **sights},
        'criteria': criteria,
        'transmissibility': amplification,
    }


def worse_pointing(figures: dict[str, Any]) -> list[str]:
    """Say that control makes the pointing worse; `figures` as `judged` gives them."""
    sights = figures['line_of_sight']
    before, words = sights['open_loop'], 'its open-loop twin in the same instants'
    if not before:
        before, words = sights['uncontrolled'], 'the stretch without control'
    if not (before and sights['controlled']):
        return []
    kind = 'measured' if math.isnan(before['true']) else 'true'
    level, baseline = (ARC_SECONDS * found[kind] for found in (sights['controlled'], before))
    if not level > _WORSE * baseline:
        return []
    return [
        f'Control makes the pointing worse: line of sight, {kind}, {level:.3g}" RMS beside {baseline:.3g}" of {words}.'
    ]


def _above(context: Context) -> float:
    scenario = context.recording.scenario
    return scenario.analysis.line_of_sight_from if scenario else 2.0


def _worst(found: FrequencyResponse | None) -> dict[str, float] | None:
    """The largest transmissibility (f,) of a strut in dB, and its frequency in Hz."""
    merit = merit_of(found) if found is not None else None
    return {'level': merit.peak, 'frequency': merit.peak_frequency} if merit else None
