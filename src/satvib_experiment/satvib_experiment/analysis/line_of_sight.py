# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Line of sight: how far the payload tilts, in radians RMS, from the truth and from the measured accelerations.

True: the strokes of the struts. The base moves all of them alike, so their differences are the payload's tilt.
Measured: the tilt's acceleration from the upper sensors, integrated twice. Below some frequency that is nothing but
sensor noise, which grows with 1 / f^2; so both are taken above a stated frequency. Both axes together are the root of
the sum of squares.
A mirror that tilts by this turns the beam by twice as much.
"""

import math
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import Rig

from satvib_experiment.analysis.bands import integrated, power_lines
from satvib_experiment.analysis.windows import Span
from satvib_experiment.recording.recording import Recording

ARC_SECONDS = 180.0 * 3600.0 / math.pi  # per radian


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
        None for a rig that is not known, or that does not tilt.
    """
    matrix = tilt_matrix(recording.rig)
    if matrix is None:
        return None
    window, dt = recording.window(*span), recording.sample_period
    tilt = true_tilt(recording, window)
    true = math.nan
    if tilt is not None:
        frequency, power = power_lines(tilt, dt)
        true = _rms(frequency, power, above)
    upper = recording.get('acceleration', 'upper')[window]
    frequency, power = power_lines(upper @ matrix.T, dt)
    measured = _rms(frequency, integrated(frequency, power, 2), above)
    return Sight(true, measured, _noise(recording, matrix, frequency, above))


def _rms(frequency: Array, power: Array, above: float) -> float:
    return float(np.sqrt(np.sum(power[frequency >= above])))


def _noise(recording: Recording, matrix: Array, frequency: Array, above: float) -> float:
    """RMS of the tilt that white noise of the sensors looks like."""
    from satvib_plant_sim.physics.noise import noise_floor

    assert recording.rig is not None
    line = noise_floor(recording.rig) ** 2 / len(frequency)
    power = np.full((len(frequency), 1), line * float(np.sum(matrix * matrix)))
    return _rms(frequency, integrated(frequency, power, 2), above)
