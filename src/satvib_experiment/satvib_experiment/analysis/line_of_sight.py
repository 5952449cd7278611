# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Line of sight: how far the payload tilts, in radians RMS, from the truth and from the measured accelerations.

True: the strokes of the struts. The base moves all of them alike, so their differences are the payload's tilt.
Measured: the tilt's acceleration from the upper sensors, integrated twice. Below some frequency that is nothing but
sensor noise, which grows with 1 / f^2; so both are taken above a stated frequency. Both axes together are the root of
the sum of squares.

"Above a frequency" is a filter, and no filter knows a moment better than about a period of its edge: what moves before
or after the stretch is in it for that long, with an amount that does not depend on the stretch's length. To filter the
whole record first does not help, for it is the filter that does this: a tone of 3.5 Hz that is ten times louder until
the stretch begins makes the RMS above 2 Hz of 0.7 s two thirds too large, that of 6 s a tenth. So the filter sees some
periods before and after the stretch, which makes its edges those of the motion and not of a cut, and a stretch of fewer
than three periods has no figure.

A wheel that runs up is loud in a part of the stretch alone. So what is below the stated frequency is taken away from
the signal, and the RMS is that of its samples: each counts alike, which under a window as for a spectrum they do not.
A mirror that tilts by this turns the beam by twice as much.
"""

import math
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import Rig

from satvib_experiment.analysis.bands import integrated
from satvib_experiment.analysis.windows import Span
from satvib_experiment.recording.recording import Recording

ARC_SECONDS = 180.0 * 3600.0 / math.pi  # per radian
PERIODS = 3.0  # of the stated frequency: no shorter stretch has a figure
_MARGIN = 4.0  # periods of the stated frequency


@dataclass(frozen=True)
class Sight:
    """Tilt of a stretch, rad RMS of both axes together; NaN where it is not known.

    Attributes:
        true: from the strokes, above the stated frequency.
        measured: from the upper accelerations, above the stated frequency.
        noise: what the noise of the sensors alone adds to `measured`.
    """

    true: float
    measured: float
    noise: float


def tilt_matrix(rig: object) -> Array | None:
    """Give the matrix (2, n) from motions along the struts (m) to the tilts about x and y (rad); None without tilts."""
    if not isinstance(rig, Rig):
        return None
    motions = payload_modes(rig)
    if len(motions.tilts) != 2:
        return None
    return np.asarray(motions.mode[list(motions.tilts)] / motions.radius)


def true_tilt(recording: Recording, window: slice = slice(None)) -> Array | None:
    """Give the tilts (samples, 2) at the samples, rad; None where they are not known."""
    matrix = tilt_matrix(recording.rig)
    if matrix is None or not recording.has('truth', 'stroke'):
        return None
    return np.asarray(recording.get('truth', 'stroke')[window] @ matrix.T)


def line_of_sight(recording: Recording, span: Span, above: float) -> Sight | None:
    """Give the tilt in a stretch of a run.

    Args:
        recording: the run.
        span: s.
        above: Hz, below which nothing counts.

    Returns:
        None for a rig that is not known, or that does not tilt, and for a stretch of fewer than `PERIODS` periods of
        `above`.
    """
    matrix = tilt_matrix(recording.rig)
    window, dt = recording.window(*span), recording.sample_period
    first, last, _ = window.indices(len(recording.time))
    if matrix is None or last - first < round(PERIODS / (above * dt)):
        return None
    tilt = true_tilt(recording)
    upper = recording.get('acceleration', 'upper')
    lines = np.asarray(np.fft.rfftfreq(len(upper[window]), dt)[1:], dtype=float)
    return Sight(
        true=math.nan if tilt is None else _rms(tilt, window, dt, above),
        measured=_rms(upper @ matrix.T, window, dt, above, integrations=2),
        noise=_noise(recording, matrix, lines, above),
    )


def _rms(signal: Array, window: slice, dt: float, above: float, integrations: int = 0) -> float:
    """RMS of all columns together in a window of a record (t, k), of what is above a frequency, after integrations.

    Samples before and after the window, where there are some, take the edges of the filter.
    """
    first, last, _ = window.indices(len(signal))
    ramp = round(_MARGIN / (above * dt))
    before, after = min(ramp, first), min(ramp, len(signal) - last)
    part = signal[first - before : last + after]
    known = np.isfinite(part)
    mean = np.where(known, part, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    around = np.where(known, part - mean, 0.0)
    rise = [0.5 - 0.5 * np.cos(np.pi * np.arange(n) / max(n, 1)) for n in (before, after)]
    weight = np.concatenate([rise[0], np.ones(last - first), rise[1][::-1]])
    lines = np.fft.rfft(around * weight[:, None], axis=0)
    frequency = np.fft.rfftfreq(len(part), dt)
    turn = 2.0 * np.pi * np.maximum(frequency, above)
    kept = np.where(frequency >= above, turn**-integrations, 0.0)
    clean = np.fft.irfft(lines * kept[:, None], n=len(part), axis=0)[before : before + last - first]
    return float(np.sqrt(np.mean(np.sum(clean * clean, axis=1))))


def _noise(recording: Recording, matrix: Array, frequency: Array, above: float) -> float:
    """RMS of the tilt that white noise of the sensors looks like."""
    from satvib_plant_sim.physics.noise import noise_floor

    assert recording.rig is not None
    line = noise_floor(recording.rig) ** 2 / len(frequency)
    power = np.full((len(frequency), 1), line * float(np.sum(matrix * matrix)))
    return float(np.sqrt(np.sum(integrated(frequency, power, 2)[frequency >= above])))
