# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which lines of an averaged spectrum the input excites, and which only show the leakage of a tone.

A tone stands 30 dB above the lines beside its main lobe, on both sides. Its strongest line is a measurement, the others
of the lobe repeat it. Further away a line counts where it has ten times the power that the window leaks from all tones.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_ident.frequency.response import FrequencyResponse
from satvib_ident.frequency.settings import FrfSettings

from satvib_experiment.frf.merit import TRUSTED

FEWEST = 8  # lines, below which tones give no curve
_HEARD = 1e-3  # lines below this share of the strongest power are not excited
_FAINT = 1e-6  # share of the strongest power, below which a line is no tone
_ABOVE_LEAKAGE = 10.0  # times the power that leaks from the tones
_BESIDE = 3  # lines beside a lobe that are compared with it
_NAMED = 5  # tones that are named


class OnlyTones(SatvibError):  # noqa: N818  # a finding, and the sentence for people
    """The input has power at a few frequencies only."""

    def __init__(self, frequencies: Array, what: str = 'the input') -> None:
        self.frequencies = frequencies
        named = [f'{f:.3g}' for f in frequencies[:_NAMED]]
        more = ' and others' if len(frequencies) > _NAMED else ''
        super().__init__(
            f'{what} moves at {", ".join(named)}{more} Hz only: no curve; excite it broadband '
            '(multisine, random, swept or stepped)'
        )

    def of(self, what: str, frequencies: Sequence[float] = ()) -> 'OnlyTones':
        """Give the same of something that has a name, with its frequencies in Hz where they are known exactly."""
        return OnlyTones(np.array(frequencies) if frequencies else self.frequencies, what)


class Excited(NamedTuple):
    """What an input excites: the lines (f,) that measure, and which of them are single tones."""

    lines: Mask
    tones: Mask


def excited_lines(power: Array, leakage: Array) -> Excited:
    """Tell excitation from leakage.

    Args:
        power: (f,) of the input, lines from the first above 0 Hz.
        leakage: (f + 1,) share of a tone's strongest line that its window leaks to the line so far away, see `leak_of`.
    """
    count = power.size
    lobe = int(np.flatnonzero(leakage >= _HEARD)[-1])
    tones = np.zeros(count, dtype=bool)
    near = np.zeros(count, dtype=bool)
    leaked = np.zeros(count)
    for p in np.argsort(power)[::-1]:
        if near[p] or power[p] <= max(_FAINT * power.max(), _ABOVE_LEAKAGE * leaked[p]):
            continue
        first, last = p - lobe - 1, p + lobe + 2  # a line of distance, where the lobe still counts
        beside = np.concatenate(
            [power[max(first - _BESIDE, 0) : max(first, 0)], power[last : last + _BESIDE]]
        )
        if beside.size and beside.max() < _HEARD * power[p]:
            tones[p] = True
            near[max(first, 0) : last] = True
            leaked += power[p] * leakage[np.abs(np.arange(count) - p)]
            # the mean of a segment that does not hold whole periods is taken off: that leaks from 0 Hz
            leaked += power[p] * (2.0 / (np.pi * (p + 1.0))) ** 2 * leakage[1 : count + 1]
    broad = ~near & (power > _ABOVE_LEAKAGE * leaked)
    if broad.any():
        loud = np.flatnonzero(broad & (power >= _HEARD * power[broad].max()))
        broad[: loud[0]] = broad[loud[-1] + 1 :] = False
    return Excited(broad | tones, tones)


def leak_of(settings: FrfSettings, length: int, count: int) -> Array:
    """Give the share (count,) that the window of `length` samples leaks from a tone to the n-th line beside it.

    The worst over the places of the tone between two lines.
    """
    from scipy.signal import get_window  # slow to import

    halves = np.abs(np.fft.fft(get_window(settings.window, length), 2 * length)) ** 2
    there = 2 * np.arange(count)
    worst = np.max(
        [
            halves[there % halves.size] / halves[0],
            halves[(there - 1) % halves.size] / halves[1],
            halves[(there + 1) % halves.size] / halves[1],
        ],
        axis=0,
    )
    return np.asarray(np.minimum(np.maximum.accumulate(worst[::-1])[::-1], 1.0))


def measuring_lines(
    found: FrequencyResponse, x: Array, dt: float, settings: FrfSettings
) -> FrequencyResponse:
    """Keep the lines of an averaged response that its input (..., t) excites.

    Raises:
        OnlyTones: the input has tones, and with them too few lines that say anything.
        SatvibError: the input does not move at all.
    """
    from satvib_ident.frequency.spectra import averaged_spectra

    matrix = averaged_spectra(x[..., None, :], dt, settings).matrix
    power = matrix[..., 0, 0].real
    power = power.reshape(-1, power.shape[-1]).max(axis=0)
    if not power.max() > 0.0:
        raise SatvibError('the input does not change')
    length = settings.segment(x.shape[-1], dt)
    excited = excited_lines(power, leak_of(settings, length, power.size + 1))
    kept = found.at_lines(excited.lines)
    coherence = np.nan_to_num(kept.coherence).reshape(-1, kept.frequency.size)
    if excited.tones.any() and np.sum(coherence.max(axis=0) >= TRUSTED) < FEWEST:
        raise OnlyTones(found.frequency[excited.tones])
    return kept
