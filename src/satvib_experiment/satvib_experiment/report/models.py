# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The models that a run identified, and how well they describe the plant."""

from typing import Any

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError
from satvib_common.levels import decibel
from satvib_common.phases import Phase
from satvib_ident.models.iir_model import IirModel

from satvib_experiment.report.context import Context


def last_identified(context: Context, strut_index: int) -> int | None:
    """Index of the sample with a strut's model at the end of the first IDENTIFY; None without one."""
    recording, span = context.recording, context.span(Phase.IDENTIFY)
    if span is None or not recording.has('model', 'a'):
        return None
    window = recording.window(0.0, span[1])
    rows = np.flatnonzero(recording.get('model', 'present')[window, strut_index])
    return int(rows[-1]) if len(rows) else None


def final_model(context: Context, strut_index: int) -> IirModel | None:
    """Model of a strut at the end of IDENTIFY; None when there is none, or it is not finite."""
    row = last_identified(context, strut_index)
    if row is None:
        return None
    a = context.recording.get('model', 'a')[row, strut_index]
    b = context.recording.get('model', 'b')[row, strut_index]
    if not (np.all(np.isfinite(a)) and np.all(np.isfinite(b))):
        return None
    return IirModel(a, b, input_delay(context), context.recording.sample_period)


def input_delay(context: Context) -> int:
    """Input delay of the identified models, samples."""
    recording = context.recording
    if recording.has('model', 'delay'):
        return int(np.max(recording.get('model', 'delay')))
    if recording.scenario is None:
        return 1
    return recording.scenario.identifier_parameters(1.0 / recording.sample_period).delay


def identify_record(context: Context, strut_index: int) -> tuple[Array, Array, Array] | None:
    """Time, measured output and voltage over IDENTIFY; None when there was no such phase."""
    span = context.span(Phase.IDENTIFY)
    if span is None or not context.recording.has('voltage'):
        return None
    window = context.recording.window(*span)
    voltage = np.nan_to_num(context.recording.get('voltage', 'voltage')[window, strut_index])
    return context.recording.time[window], context.measured(window)[:, strut_index], voltage


def fit(measured: Array, modelled: Array) -> float:
    """1 - |y - yhat| / |y - mean y|; 1 is perfect, 0 no better than the mean."""
    good = np.isfinite(measured) & np.isfinite(modelled)
    y, x = measured[good], modelled[good]
    spread = float(np.linalg.norm(y - y.mean())) if len(y) else 0.0
    return 1.0 - float(np.linalg.norm(y - x)) / spread if spread else float('nan')


def model_summary(context: Context, strut_index: int) -> dict[str, Any] | None:
    """Parameters, poles and fits of a strut's model, as plain data; None without a model."""
    model, row = final_model(context, strut_index), last_identified(context, strut_index)
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
        'standard_deviation': recording.get('model', 'standard_deviation')[row, strut_index],
        'poles': [[p.real, p.imag] for p in poles],
        'natural_frequency': frequency,
        'damping': damping,
        'converged': bool(recording.get('model', 'converged')[row, strut_index]),
        'reason': str(recording.get('model', 'reason')[row, strut_index]),
        **trust_figures(context, strut_index, row),
        'response_errors': response_errors(context, strut_index),
        'fit_one_step': float('nan'),
        'fit_free_run': float('nan'),
    }
    record = identify_record(context, strut_index)
    if record is not None:
        _, measured, voltage = record
        summary['fit_one_step'] = fit(measured, np.asarray(model.predict(measured, voltage)))
        summary['fit_free_run'] = fit(measured, np.asarray(model.simulate(voltage)))
    return summary


# figures that decide about trust, and the parameter of the identifier that limits each
TRUST = {'response_deviation': 'trust_deviation', 'model_error': 'trust_error'}


def trust_limits(context: Context) -> dict[str, float]:
    """Limit of each figure of trust; NaN where the run does not say which identifier it had."""
    scenario = context.recording.scenario
    if scenario is None:
        return dict.fromkeys(TRUST, float('nan'))
    parameters = scenario.identifier_parameters(1.0 / context.recording.sample_period)
    return {name: float(getattr(parameters, limit)) for name, limit in TRUST.items()}


def trust_figures(context: Context, strut_index: int, row: int) -> dict[str, float]:
    """Figures of trust of a strut at a sample, each beside its limit; NaN where they were not recorded."""
    found: dict[str, float] = {}
    for name, limit in trust_limits(context).items():
        known = context.recording.has('model', name)
        value = context.recording.get('model', name)[row, strut_index] if known else float('nan')
        found |= {name: float(value), f'{name}_limit': limit}
    return found


def true_response(context: Context, strut_index: int, frequency: Array) -> Complex:
    """Exact sampled response of the simulated rig from a strut's voltage to its measured acceleration.

    Args:
        context: a run whose rig is known.
        strut_index: from 0.
        frequency: (f,) Hz.
    """
    from satvib_plant_sim.responses.one_strut import strut_response

    assert context.recording.rig is not None
    return strut_response(context.recording.rig, strut_index, frequency)


def response_errors(context: Context, strut_index: int) -> list[dict[str, float]]:
    """How far a strut's model is from the rig at each tone: phase in degrees, magnitude in dB."""
    model, tones = final_model(context, strut_index), np.array(context.evaluation.frequencies)
    if model is None or context.recording.rig is None or not len(tones):
        return []
    ratio = model.frequency_response(tones) / true_response(context, strut_index, tones)
    return [
        {
            'frequency': float(f),
            'phase': float(np.degrees(np.angle(r))),
            'magnitude': float(decibel(abs(r))),
        }
        for f, r in zip(tones, ratio, strict=True)
    ]
