# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a run achieved: levels and attenuations, as measured and true, with the noise floor and the open-loop twin."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.levels import decibel, largest_known, mean_of_known, rms
from satvib_common.phases import Phase

from satvib_experiment.analysis.levels import moving_rms, tone_floor, tone_level
from satvib_experiment.analysis.tones import disturbance_onset, disturbance_tones
from satvib_experiment.analysis.windows import Span, Windows, find_windows
from satvib_experiment.recording.recording import Recording
from satvib_experiment.recording.signals import fine

KINDS = ('measured_rms', 'measured_tone', 'true_rms', 'true_tone')
# a run has settled once its level stays within this of the level in the controlled window
_SETTLED = 3.0
# before that share of its largest level the open loop is no baseline for an amplification
_QUIET = 0.1
# m/s^2 RMS: what is left of a run that nothing shakes is rounding, 1e-13 or less
_SILENT = 1e-9


@dataclass
class Evaluation:
    """Figures per strut; levels in m/s^2, attenuations in dB with negative better, NaN where unknown.

    Attributes:
        windows: the stretches compared; none without control where nothing shakes the payload in it.
        at_rest: where nothing shakes the payload in the stretch under control (struts,): no attenuation there.
        frequencies: Hz, the tones fitted.
        levels: by window ('uncontrolled', 'controlled', 'open_loop') and kind (see `KINDS`), (struts,).
        attenuation: controlled against uncontrolled by kind, (struts,), Eq. (42).
        attenuation_open_loop: controlled against the open-loop twin in the same instants.
        noise: RMS of the sensor noise in the loop's samples, m/s^2.
        floor: the attenuation by kind that would leave nothing but that noise in the loop's samples.
        settling_time: s after the beginning of CONTROL.
        largest_amplification: dB, largest ratio of the moving RMS to that of the open-loop twin.
        largest_voltage: V.
        saturated_share: part of the samples under control at which the guard stepped in.
        clipped: by sensor ('upper', 'lower'), samples of the whole run at an end of its range, (struts,).
        reference, reference_source: figures to compare with, from the scenario.
        notes: what a reader must know, in sentences.
    """

    struts: tuple[str, ...]
    windows: Windows
    frequencies: tuple[float, ...]
    levels: dict[str, dict[str, Array]]
    attenuation: dict[str, Array]
    attenuation_open_loop: dict[str, Array]
    noise: float
    floor: dict[str, Array]
    settling_time: Array
    largest_amplification: Array
    largest_voltage: Array
    saturated_share: Array
    at_rest: Mask
    clipped: dict[str, Integers]
    reference: tuple[float, ...] = ()
    reference_source: str = ''
    notes: list[str] = field(default_factory=list)


def evaluate(recording: Recording, open_loop: Recording | None = None) -> Evaluation:
    """Compare a run with itself before control, and with its open-loop twin.

    Args:
        recording: the run.
        open_loop: the same scenario and seed with every voltage zero, when it could be simulated.

    Raises:
        SatvibError: the recording ends before its own windows.
    """
    scenario = recording.scenario
    onset = disturbance_onset(scenario.make_disturbance()) if scenario else 0.0
    tones = _tones(recording)
    windows = find_windows(recording, onset)
    if windows.uncontrolled and _at_rest(open_loop or recording, windows.uncontrolled).all():
        windows = Windows(None, windows.controlled)
    at_rest = np.zeros(len(recording.struts), dtype=bool)
    if windows.controlled and open_loop is not None:
        at_rest = _at_rest(open_loop, windows.controlled)
    nothing = {kind: np.full(len(recording.struts), np.nan) for kind in KINDS}
    levels = {'uncontrolled': nothing, 'controlled': nothing, 'open_loop': nothing}
    if windows.uncontrolled:
        levels['uncontrolled'] = _levels(recording, windows.uncontrolled, tones)
    if windows.controlled:
        levels['controlled'] = _levels(recording, windows.controlled, tones)
        if open_loop is not None:
            levels['open_loop'] = _levels(open_loop, windows.controlled, tones)
    before = 'uncontrolled' if windows.uncontrolled else 'open_loop'
    noise = _noise(recording)
    settling, amplification = _transient(recording, open_loop, windows, levels)
    baseline = _audible(levels[before], at_rest)
    control = recording.phase == Phase.CONTROL
    return Evaluation(
        struts=recording.struts,
        windows=windows,
        frequencies=tuple(tones),
        levels=levels,
        attenuation=_attenuation(levels['controlled'], baseline),
        attenuation_open_loop=_attenuation(
            levels['controlled'], _audible(levels['open_loop'], at_rest)
        ),
        noise=noise,
        floor=_floor(recording, noise, windows, baseline, len(tones)),
        settling_time=np.where(at_rest, np.nan, settling),
        largest_amplification=amplification,
        largest_voltage=_largest_voltage(recording),
        saturated_share=_share(recording, control),
        at_rest=at_rest,
        clipped={sensor: _clipped(recording, sensor) for sensor in ('upper', 'lower')},
        reference=scenario.analysis.reference if scenario else (),
        reference_source=scenario.analysis.reference_source if scenario else '',
    )


def _tones(recording: Recording) -> list[float]:
    scenario = recording.scenario
    if scenario is None:
        return []
    given = list(scenario.analysis.frequencies) or disturbance_tones(scenario.make_disturbance())
    return [f for f in given if f < 0.5 / recording.sample_period]


def _levels(recording: Recording, span: Span, tones: Sequence[float]) -> dict[str, Array]:
    window = recording.window(*span)
    measured = recording.get('acceleration', 'upper')[window]
    result = {
        'measured_rms': rms(measured),
        'measured_tone': tone_level(measured, recording.sample_period, tones),
    }
    if recording.has('truth', 'upper'):
        true = fine(recording, window)
        result['true_rms'] = rms(true)
        result['true_tone'] = tone_level(true, recording.fine_period, tones)
    else:
        unknown = np.full(len(recording.struts), np.nan)
        result['true_rms'] = result['true_tone'] = unknown
    return result


def _at_rest(recording: Recording, span: Span) -> Mask:
    """Where the payload does not move in a stretch (struts,), by the truth where there is truth."""
    window = recording.window(*span)
    true = recording.has('truth', 'upper')
    signal = fine(recording, window) if true else recording.get('acceleration', 'upper')[window]
    return np.asarray(rms(signal) <= _SILENT)


def _audible(level: dict[str, Array], at_rest: Mask) -> dict[str, Array]:
    """Levels to compare with; NaN where nothing shakes the payload."""
    return {
        kind: np.where(at_rest | (level['true_rms'] <= _SILENT), np.nan, value)
        for kind, value in level.items()
    }


def _attenuation(level: dict[str, Array], baseline: dict[str, Array]) -> dict[str, Array]:
    return {kind: decibel(level[kind], baseline[kind]) for kind in KINDS}


def _noise(recording: Recording) -> float:
    if recording.rig is None:
        return float('nan')
    from satvib_plant_sim.physics.noise import noise_floor

    return noise_floor(recording.rig)


def _floor(
    recording: Recording, noise: float, windows: Windows, baseline: dict[str, Array], tones: int
) -> dict[str, Array]:
    samples = 0
    if windows.controlled:
        window = recording.window(*windows.controlled)
        samples = len(recording.sequence[window])
    return {
        'measured_rms': decibel(np.array(noise), baseline['measured_rms']),
        'measured_tone': decibel(
            np.array(tone_floor(noise, samples, tones)), baseline['measured_tone']
        ),
    }


def _transient(
    recording: Recording,
    open_loop: Recording | None,
    windows: Windows,
    levels: dict[str, dict[str, Array]],
) -> tuple[Array, Array]:
    """Settling time and largest amplification, judged in truth where there is truth."""
    unknown = np.full(len(recording.struts), np.nan)
    start = recording.plan.first_of(Phase.CONTROL)
    if start is None or windows.controlled is None:
        return unknown, unknown
    first = start - int(recording.sequence[0])
    if first < 0:  # the beginning of CONTROL was not recorded
        return unknown, unknown
    level = running_level(recording)
    kind = 'true_rms' if recording.has('truth', 'upper') else 'measured_rms'
    limit = levels['controlled'][kind] * 10.0 ** (_SETTLED / 20.0)
    late = level[first:] > limit
    last = np.where(late.any(axis=0), len(late) - np.argmax(late[::-1], axis=0), 0)
    settling = np.where(last < len(late), last * recording.sample_period, np.nan)
    if open_loop is None:
        return settling, unknown
    base = running_level(open_loop)[first : len(level)]
    loud = base > _QUIET * base.max(axis=0)
    ratio = np.where(loud, level[first:] / np.where(loud, base, 1.0), 0.0)
    return settling, decibel(ratio.max(axis=0), np.ones(len(recording.struts)))


def running_level(recording: Recording, window: float = 0.25) -> Array:
    """Moving RMS per sample (samples, struts) over `window` s, of the truth where there is truth."""
    if recording.has('truth', 'upper'):
        truth = recording.get('truth', 'upper')
        square = np.sqrt(mean_of_known(truth**2, axis=2))
        return moving_rms(square, round(window / recording.sample_period))
    upper = recording.get('acceleration', 'upper')
    quiet = recording.get('state', 'bias_upper') if recording.has('state') else 0.0
    return moving_rms(upper - quiet, round(window / recording.sample_period))


def _largest_voltage(recording: Recording) -> Array:
    if not recording.has('voltage'):
        return np.full(len(recording.struts), np.nan)
    return largest_known(recording.get('voltage', 'voltage'), axis=0)


def _share(recording: Recording, control: NDArray[Any]) -> Array:
    if not recording.has('voltage') or not control.any():
        return np.full(len(recording.struts), np.nan)
    return np.asarray(recording.get('voltage', 'saturated')[control].mean(axis=0))


def _clipped(recording: Recording, sensor: str) -> Integers:
    """Clipped samples (struts); 0 in a bag that is older than the mark."""
    if not recording.has('acceleration', f'{sensor}_clipped'):
        return np.zeros(len(recording.struts), dtype=np.int64)
    return np.asarray(np.count_nonzero(recording.get('acceleration', f'{sensor}_clipped'), axis=0))
