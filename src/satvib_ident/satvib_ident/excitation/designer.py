# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Choose an excitation from what is known before anything is identified.

A strut of natural frequency w_n and damping zeta, with g m/s^2 per volt far above it, moves by

    X(f) / V = g / |w_n^2 - w^2 + 2 j zeta w_n w|,   acceleration A(f) = w^2 X(f)

The signal is a multisine of `duration` / 2 (so that two periods fit). Its highest line lies at a quarter of the
sample rate, or at the corner of the anti-alias filter if that is lower. Its lowest is the first whose acceleration
is above the noise: a line of amplitude A in N samples of noise sigma is known to sigma sqrt(2 / N), and three
times that is wanted. The amplitude is what the voltage limit and the stroke limit allow, with a margin of 20 %.
"""

import math
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param

from satvib_ident.excitation.multisine import Multisine

MARGIN = 0.8
STANDS_OUT = 3.0


@dataclass(frozen=True, kw_only=True)
class ExcitationTask(Schema):
    """What is known about a strut and its acquisition."""

    sample_rate: float = param(description='sample rate', unit='Hz', above=0.0)
    duration: float = param(2.0, 'time for the identification', unit='s', above=0.0)
    voltage_limit: float = param(20.0, 'largest voltage', unit='V', above=0.0)
    stroke_limit: float = param(7.6e-3, 'largest motion of the coil', unit='m', above=0.0)
    noise: float = param(0.098, 'deviation of the upper acceleration', unit='m/s^2', minimum=0.0)
    gain: float = param(1.2, 'acceleration per volt far above resonance', unit='m/s^2/V', above=0.0)
    natural_frequency: float = param(
        0.0, 'natural frequency of the strut, roughly; 0: a free mass', unit='Hz', minimum=0.0
    )
    damping: float = param(0.05, 'damping ratio, roughly', minimum=0.0)
    corner: float = param(0.0, 'corner of the anti-alias filter; 0: none', unit='Hz', minimum=0.0)
    struts: int = param(1, 'struts excited at the same time', minimum=1)


@dataclass(frozen=True)
class ExcitationDesign:
    """What was chosen, and what to expect of it.

    Attributes:
        name: for `make_excitation`.
        options: likewise: amplitude (V), dt (s), low, high (Hz), period (s), struts.
        peak_stroke: m, steady state.
        line_to_noise: smallest ratio of a line's acceleration to what the noise hides.
        limited_by: 'voltage' or 'stroke'.
    """

    name: str
    options: dict[str, float | int]
    peak_stroke: float
    line_to_noise: float
    limited_by: str


def _compliance(task: ExcitationTask, f: Array) -> Complex:
    w, wn = 2.0 * math.pi * f, 2.0 * math.pi * task.natural_frequency
    return np.asarray(task.gain / (wn * wn - w * w + 2j * task.damping * wn * w))


def _peak_stroke(task: ExcitationTask, signal: Multisine) -> float:
    """Largest motion in steady state, at four times the sample rate."""
    lines, count = signal.own_lines, signal.count
    spectrum = np.zeros(2 * count + 1, dtype=complex)
    spectrum[lines] = (
        4.0 * np.fft.rfft(signal.values)[lines] * _compliance(task, lines / (count * signal.dt))
    )
    return float(np.max(np.abs(np.fft.irfft(spectrum, 4 * count))))


def design_excitation(task: ExcitationTask) -> ExcitationDesign:
    """Choose band and amplitude.

    Raises:
        SatvibError: no line of the band would stand out of the noise.
    """
    dt, period = 1.0 / task.sample_rate, task.duration / 2.0
    high = 0.25 * task.sample_rate
    if task.corner > 0.0:
        high = min(high, task.corner)
    low = 1.0 / period
    if high < low:
        raise SatvibError(f'duration: {task.duration} s is too short for a band below {high:g} Hz')
    hidden = task.noise * math.sqrt(2.0 * dt / task.duration)
    while True:
        options: dict[str, float | int] = {
            'amplitude': MARGIN * task.voltage_limit, 'dt': dt, 'low': low, 'high': high,
            'period': period, 'struts': task.struts,
        }  # fmt: skip
        signals = [Multisine.from_mapping(options | {'strut': s}) for s in range(task.struts)]
        stroke = max(_peak_stroke(task, signal) for signal in signals)
        scale = min(1.0, MARGIN * task.stroke_limit / stroke)
        options['amplitude'] = scale * MARGIN * task.voltage_limit
        lines = signals[0].lines
        f = lines / (signals[0].count * dt)
        level = min(
            2.0 * float(np.abs(np.fft.rfft(s.values)[s.own_lines]).mean()) / s.count
            for s in signals
        )
        seen = scale * level * (2.0 * math.pi * f) ** 2 * np.abs(_compliance(task, f))
        loud = seen >= STANDS_OUT * hidden
        if loud[0]:
            ratio = float(seen.min() / hidden) if hidden > 0.0 else math.inf
            return ExcitationDesign(
                'multisine', options, scale * stroke, ratio, 'stroke' if scale < 1.0 else 'voltage'
            )
        if not loud.any() or lines.size <= task.struts:
            raise SatvibError(
                f'noise: {task.noise} m/s^2 hides every line that {options["amplitude"]:.3g} V can '
                f'make in {task.duration} s; identify for longer'
            )
        low = float(f[max(int(np.argmax(loud)), 1)])
