# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Signals of a recording as one line of time."""

import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import mean_of_known

from satvib_experiment.recording.recording import Recording


def fine(recording: Recording, window: slice = slice(None), plate: str = 'upper') -> Array:
    """The truth on the fine grid, in one line of time: (samples * fine, struts)."""
    truth = recording.get('truth', plate)[window]
    return np.moveaxis(truth, 1, 2).reshape(-1, truth.shape[1])


def without_bias(recording: Recording, window: slice = slice(None)) -> Array:
    """Upper acceleration as sampled (samples, struts), m/s^2, less what the sensor read at rest.

    That is the last bias that the controllers calibrated. Without their states it is the mean of the whole run.
    """
    upper = recording.get('acceleration', 'upper')
    bias = mean_of_known(upper)
    if recording.has('state', 'bias_upper'):
        calibrated = last_known(recording.get('state', 'bias_upper'))
        bias = np.where(np.isfinite(calibrated), calibrated, bias)
    return np.asarray((upper - bias)[window])


def last_known(values: Array) -> Array:
    """Last value of each strut (struts,) that is not NaN; NaN where all are. `values` is (samples, struts)."""
    known = np.isfinite(values)
    last = len(values) - 1 - np.argmax(known[::-1], axis=0)
    return np.asarray(values[last, np.arange(values.shape[1])])
