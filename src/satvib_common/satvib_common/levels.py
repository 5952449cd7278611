# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Levels of a signal, and their ratio in dB."""

import numpy as np
from numpy.typing import ArrayLike

from satvib_common.arrays import Array


def decibel(level: ArrayLike, baseline: ArrayLike = 1.0) -> Array:
    """Ratio of two levels in dB, 20 log10(level / baseline), Eq. (42); NaN where either is not positive."""
    with np.errstate(divide='ignore', invalid='ignore'):
        ratio = np.asarray(level, dtype=float) / np.asarray(baseline, dtype=float)
        result: Array = 20.0 * np.log10(np.where((ratio > 0) & np.isfinite(ratio), ratio, np.nan))
    return result


def rms(signal: Array) -> Array:
    """RMS without the mean over the first axis; (samples, ...) gives (...). NaN samples are left out."""
    count = np.sum(np.isfinite(signal), axis=0)
    with np.errstate(divide='ignore', invalid='ignore'):
        mean = np.nansum(signal, axis=0) / count
        result: Array = np.sqrt(np.nansum((signal - mean) ** 2, axis=0) / count)
    return result


def rms_with_mean(signal: Array) -> Array:
    """Root of the mean square over the first axis; (samples, ...) gives (...)."""
    result: Array = np.sqrt(np.mean(signal * signal, axis=0))
    return result


def mean_of_known(signal: Array, axis: int = 0) -> Array:
    """Mean over an axis without the values that are NaN; NaN where all of them are."""
    known = ~np.isnan(signal)
    with np.errstate(divide='ignore', invalid='ignore'):
        result: Array = np.sum(np.where(known, signal, 0.0), axis=axis) / np.sum(known, axis=axis)
    return result


def largest_known(signal: Array, axis: int | None = None) -> Array:
    """Largest magnitude without the values that are NaN; NaN where all of them are."""
    known = ~np.isnan(signal)
    most = np.max(np.where(known, np.abs(signal), -1.0), axis=axis, initial=-1.0)
    result: Array = np.where(most < 0.0, np.nan, most)
    return result
