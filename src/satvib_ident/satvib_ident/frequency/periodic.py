# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Frequency responses from an excitation that repeats: no leakage, and a variance that is measured.

Each period gives a spectrum at its own lines, X_p and Y_p. With the means over P periods

    H = mean(Y) / mean(X),   variance of H = sum_p |E_p|^2 / (P (P - 1) |mean(X)|^2),   E_p = Y_p - H X_p

where noise at both, also noise that both have in common, is allowed for. A stepped sine is the same thing with one line
at a time, and blocks of its dwell in the place of periods.

R. Pintelon and J. Schoukens, System Identification: A Frequency Domain Approach, 2nd edition, 2012, section 2.5.
"""

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError

from satvib_ident.frequency.confidence import disc_factor
from satvib_ident.frequency.response import FrequencyResponse

# lines of the input below this share of the strongest one are not excited
EXCITED = 0.02


def response_of_blocks(
    frequency: Array, x: Complex, y: Complex, confidence: float = 0.95, method: str = ''
) -> FrequencyResponse:
    """Estimate from the lines of several blocks.

    Args:
        frequency: (f,) Hz.
        x: (..., P, f) lines of the input in each block, with one phase reference.
        y: (..., P, f) lines of the output.
        confidence: of the disc.
        method: for people.

    Raises:
        SatvibError: fewer than two blocks.
    """
    count = x.shape[-2]
    if count < 2:
        raise SatvibError(f'{count} periods: at least two are needed to measure a variance')
    mean_x, mean_y = x.mean(axis=-2), y.mean(axis=-2)
    with np.errstate(divide='ignore', invalid='ignore'):
        value = mean_y / mean_x
        error = y - value[..., None, :] * x
        power = np.sum(np.abs(error) ** 2, axis=-2)
        variance = power / (count * (count - 1) * np.abs(mean_x) ** 2)
        radius = np.sqrt(disc_factor(count - 1, confidence) * variance)
        cross = np.abs(np.sum(y * x.conj(), axis=-2)) ** 2
        coherence = cross / (np.sum(np.abs(x) ** 2, axis=-2) * np.sum(np.abs(y) ** 2, axis=-2))
    return FrequencyResponse(frequency, value, coherence, radius, float(count), confidence, method)


def periodic_response(
    x: Array, y: Array, dt: float, period: int, confidence: float = 0.95
) -> FrequencyResponse:
    """Estimate from whole periods in the steady state; the last ones of the record are taken.

    Args:
        x: (..., t) input.
        y: (..., t) output.
        dt: s.
        period: samples.
        confidence: of the disc.

    Returns:
        Values at the excited lines: those of which the input has at least 2 % of its strongest one.

    Raises:
        SatvibError: fewer than two whole periods without a gap.
    """
    x, y = np.broadcast_arrays(x, y)
    lines_x, lines_y = _period_lines(x, period), _period_lines(y, period)
    axes = tuple(i for i in range(lines_x.ndim) if i != lines_x.ndim - 2)
    whole = np.isfinite(lines_x).all(axis=axes) & np.isfinite(lines_y).all(axis=axes)
    lines_x, lines_y = lines_x[..., whole, :], lines_y[..., whole, :]
    if whole.sum() < 2:
        raise SatvibError(
            f'{int(whole.sum())} whole periods of {period * dt:g} s: at least two are needed'
        )
    frequency = np.arange(1, lines_x.shape[-1] + 1) / (period * dt)
    power = np.abs(lines_x.mean(axis=-2)) ** 2
    power = power.reshape(-1, power.shape[-1]).mean(axis=0)
    keep = power >= EXCITED**2 * power.max()
    return response_of_blocks(
        frequency[keep], lines_x[..., keep], lines_y[..., keep], confidence,
        f'{int(whole.sum())} periods of {period * dt:.3g} s',
    )  # fmt: skip


def _period_lines(signal: Array, period: int) -> Complex:
    """Lines (..., P, f) of the whole periods at the end of a signal (..., t), without 0 and half the sample rate."""
    count = signal.shape[-1] // period
    end = signal[..., signal.shape[-1] - count * period :]
    blocks = end.reshape(*signal.shape[:-1], count, period)
    return np.asarray(np.fft.rfft(blocks, axis=-1)[..., 1 : (period + 1) // 2])


def tone_lines(signal: Array, dt: float, frequency: float, blocks: int) -> Complex:
    """Fit a tone to blocks of a signal, all with the phase of the signal's first sample.

    Args:
        signal: (..., t), the steady state at one frequency.
        dt: s.
        frequency: Hz.
        blocks: how many; each is a whole number of periods as nearly as samples allow.

    Returns:
        (..., blocks) complex amplitudes, by least squares of cosine, sine and a constant.

    Raises:
        SatvibError: a block is shorter than a period.
    """
    samples = signal.shape[-1]
    per_period = 1.0 / (frequency * dt)
    periods = int(samples / blocks / per_period)
    length = round(periods * per_period)
    if periods < 1 or length < 4:
        raise SatvibError(
            f'{samples * dt:.3g} s at {frequency:g} Hz are less than {blocks} periods: stay longer at each frequency'
        )
    found = []
    for block in range(blocks):
        at = samples - (blocks - block) * length + np.arange(length)
        angle = 2.0 * np.pi * frequency * dt * at
        basis = np.column_stack([np.cos(angle), -np.sin(angle), np.ones(length)])
        part = signal[..., at].reshape(-1, length).T
        fitted = np.linalg.lstsq(basis, part, rcond=None)[0]
        found.append((fitted[0] + 1j * fitted[1]).reshape(signal.shape[:-1]))
    return np.stack(found, axis=-1)


def stepped_response(
    x: Array, y: Array, dt: float, steps: list[tuple[float, int, int]], blocks: int = 4, confidence: float = 0.95
) -> FrequencyResponse:  # fmt: skip
    """Estimate from a sine that stays at one frequency after the other.

    Args:
        x: (..., t) input.
        y: (..., t) output.
        dt: s.
        steps: frequency in Hz, first sample of its steady state, and the sample at which it ends.
        blocks: into which each steady state is cut.
        confidence: of the disc.

    Raises:
        SatvibError: a steady state is shorter than `blocks` periods.
    """
    x, y = np.broadcast_arrays(x, y)
    lines_x = [tone_lines(x[..., first:end], dt, f, blocks) for f, first, end in steps]
    lines_y = [tone_lines(y[..., first:end], dt, f, blocks) for f, first, end in steps]
    return response_of_blocks(
        np.array([f for f, _, _ in steps]), np.stack(lines_x, axis=-1), np.stack(lines_y, axis=-1),
        confidence, f'stepped sine, {blocks} blocks a step',
    )  # fmt: skip
