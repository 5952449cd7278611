# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The models that a run identified, and how well they tell what the plant did."""

from typing import Any

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError
from satvib_common.levels import decibel
from satvib_common.phases import Phase
from satvib_ident.models.iir_model import IirModel

from satvib_experiment.report.context import Context


def last_identified(context: Context, strut: int) -> int | None:
    """Index of the sample with a strut's model at the end of the first IDENTIFY; None without one."""
    recording, span = context.recording, context.span(Phase.IDENTIFY)
    if span is None or not recording.has('model', 'a'):
        return None
    window = recording.window(0.0, span[1])
    rows = np.flatnonzero(recording.get('model', 'present')[window, strut])
    return int(rows[-1]) if len(rows) else None


def final_model(context: Context, strut: int) -> IirModel | None:
    """Model of a strut at the end of IDENTIFY; None when there is none, or it is not finite."""
    row = last_identified(context, strut)
    if row is None:
        return None
    a = context.recording.get('model', 'a')[row, strut]
    b = context.recording.get('model', 'b')[row, strut]
    if not (np.all(np.isfinite(a)) and np.all(np.isfinite(b))):
        return None
    return IirModel(a, b, input_delay(context), context.recording.sample_period)


def input_delay(context: Context) -> int:
    """Input delay of the identified models, samples."""
    recording = context.recording
    if recording.has('model', 'delay'):
        return int(np.nanmax(recording.get('model', 'delay')))
    if recording.scenario is None:
        return 1
    return recording.scenario.identifier_parameters(1.0 / recording.sample_period).delay


def identify_record(context: Context, strut: int) -> tuple[Array, Array, Array] | None:
    """Time, measured output and voltage over IDENTIFY; None when there was no such phase."""
    span = context.span(Phase.IDENTIFY)
    if span is None or not context.recording.has('voltage'):
        return None
    window = context.recording.window(*span)
    voltage = np.nan_to_num(context.recording.get('voltage', 'voltage')[window, strut])
    return context.recording.time[window], context.measured(window)[:, strut], voltage


def fit(measured: Array, modelled: Array) -> float:
    """1 - |y - yhat| / |y - mean y|; 1 is perfect, 0 no better than the mean."""
    good = np.isfinite(measured) & np.isfinite(modelled)
    y, x = measured[good], modelled[good]
    spread = float(np.linalg.norm(y - y.mean())) if len(y) else 0.0
    return 1.0 - float(np.linalg.norm(y - x)) / spread if spread else float('nan')


def model_summary(context: Context, strut: int) -> dict[str, Any] | None:
    """Parameters, poles and fits of a strut's model, as plain data; None without a model."""
    model, row = final_model(context, strut), last_identified(context, strut)
    if model is None or row is None:
        return None
    recording = context.recording
    try:
        frequency, damping = float(model.natural_frequency()), float(model.damping())
    except SatvibError:
        frequency = damping = float('nan')
    poles = np.atleast_1d(model.poles())
    summary = {
        'a': model.a,
        'b': model.b,
        'delay': model.delay,
        'standard_deviation': recording.get('model', 'standard_deviation')[row, strut],
        'poles': [[p.real, p.imag] for p in poles],
        'natural_frequency': frequency,
        'damping': damping,
        'converged': bool(recording.get('model', 'converged')[row, strut]),
        'reason': str(recording.get('model', 'reason')[row, strut]),
        'response_errors': response_errors(context, strut),
        'fit_one_step': float('nan'),
        'fit_free_run': float('nan'),
    }
    record = identify_record(context, strut)
    if record is not None:
        _, measured, voltage = record
        summary['fit_one_step'] = fit(measured, np.asarray(model.predict(measured, voltage)))
        summary['fit_free_run'] = fit(measured, np.asarray(model.simulate(voltage)))
    return summary


def true_response(context: Context, strut: int, frequency: Array) -> Complex:
    """Exact sampled response of the simulated rig from a strut's voltage to its measured acceleration.

    Args:
        context: a run whose rig is known.
        strut: index.
        frequency: (f,) Hz.
    """
    from satvib_plant_sim.responses.one_strut import strut_response

    assert context.recording.rig is not None
    return strut_response(context.recording.rig, strut, frequency)


def response_errors(context: Context, strut: int) -> list[dict[str, float]]:
    """How far a strut's model is from the rig at each tone: phase in degrees, magnitude in dB."""
    model, tones = final_model(context, strut), np.array(context.evaluation.frequencies)
    if model is None or context.recording.rig is None or not len(tones):
        return []
    ratio = model.frequency_response(tones) / true_response(context, strut, tones)
    return [
        {
            'frequency': float(f),
            'phase': float(np.degrees(np.angle(r))),
            'magnitude': float(decibel(abs(r))),
        }
        for f, r in zip(tones, ratio, strict=True)
    ]
