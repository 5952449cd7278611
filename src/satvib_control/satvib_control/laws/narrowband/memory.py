# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What law narrowband keeps of a strut: the places in each array, and the groups that the kernels take.

All arrays are float64. The law holds them with the leading axes `shape`; a kernel sees those of one item.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array


class Setting(IntEnum):
    """Places in `settings`; the same for all items."""

    PACE = 0  # samples; the wanted pace
    LONGEST = 1  # samples; longest memory of a tone's frequency
    LOW = 2  # rad/sample; lowest frequency that is searched
    HIGH = 3  # rad/sample; highest one
    SMALLEST = 4  # m/s^2; smallest amplitude of a tone
    VOLTAGE = 5  # V; limit of all amplitudes together
    SENSITIVITY = 6  # largest max |S|
    FIRST_HOLD = 7  # samples
    WINDOW = 8  # samples; length of the search's window
    LEAST = 9  # rad/sample; lowest frequency that is cancelled
    MOST = 10  # rad/sample; highest one


class Tone(IntEnum):
    """Places in a row of `tones`; `tracker` writes them, `step` FADE."""

    RE = 0  # m/s^2; the rotating complex number x, predicted or corrected
    IM = 1
    OMEGA = 2  # rad/sample; frequency
    RATE = 3  # rad/sample^2; rate of the frequency
    MEMORY = 4  # samples; N, memory of the frequency
    ON = 5  # 1: the tone is tracked, 0: the place is free
    QUADRATURE = 6  # m/s^2; q, mean of the error's quadrature
    AGE = 7  # samples since the tone was found
    PACE = 8  # samples; n, in which amplitude and phase follow; 0 before the first sample
    FADE = 9  # share of the tone's voltage that is let through
    LEFT_RE = 10  # m/s^2; what is left of the tone in y, in the frame of x; `proof` writes this and the rest
    LEFT_IM = 11
    START = 12  # m/s^2; |x| when its voltage began
    TRIED = 13  # paces for which its voltage has not calmed it
    PROVEN = 14  # 1: its voltage has calmed it
    BARRED = 15  # samples for which it gets no voltage


class Tracking(IntEnum):
    """Places in `tracking`, what the tones of an item share; `tracker`, `search` and `margin` write them."""

    POINTER = 0  # place of the oldest sample in the rings
    SEEN = 1  # samples so far
    STRETCH = 2  # factor on all paces, at least 1
    SPECTRA = 3  # weight of the spectra in the noise floor, in spectra
    NEWS = 4  # SEEN when a tone was found or jumped
    TOP = (
        5  # (m/s^2)^2; P of the strongest tone that was found or jumped since the last quiet window
    )
    SENSITIVITY = 6  # max |S| on the model
    ERROR_POWER = 7  # (m/s^2)^2; of e, over a quarter of the window
    DISTURBANCE_POWER = 8  # (m/s^2)^2; of d, likewise
    USUAL_ERROR = 9  # (m/s^2)^2; of e, over 16 windows
    BAD_SAMPLES = 10  # samples for which the tones have explained too little
    BARRED_OMEGA = 11  # rad/sample; of the tone that was barred last
    BARRED_UNTIL = 12  # SEEN up to which it is
    NEXT_BAR = 13  # samples; length of the next bar


class Backoff(IntEnum):
    """Places in `backoff`; `backoff` writes them, `step` what the voltage is: VOLTS and FADED."""

    LEVEL = 0  # (m/s^2)^2; power of y over a pace
    HEARD = 1  # samples in LEVEL
    QUICK_LEVEL = 2  # (m/s^2)^2; power of y over half a pace
    QUICK_EFFECT = 3  # (m/s^2)^2; power of G u over half a pace
    PASSIVE_PEAK = (
        4  # (m/s^2)^2; QUICK_LEVEL at its highest while the voltage could not be the cause
    )
    BASE = 5  # (m/s^2)^2; power of y at 0 V
    BASE_KNOWN = 6  # 1: BASE was measured at 0 V
    RESTING_LEVEL = 7  # (m/s^2)^2; power of y in a hold, over four paces
    LEAST = 8  # (m/s^2)^2; least RESTING_LEVEL of the hold
    SILENT = 9  # samples at 0 V in a row
    VOLTS = 10  # V; amplitudes of the voltage together
    FADED = 11  # largest share of a tone's voltage that is let through
    LOUD = 12  # samples, weighted by growth; suspicion of a loud vibration
    USELESS = 13  # samples; suspicion of a voltage without use
    BEFORE = (
        14  # (m/s^2)^2; LEVEL when the hold began; infinite when the law is the cause in any case
    )
    HOLD = 15  # samples left of the hold; 0: no hold
    EXTENDED = 16  # 1: this hold is not extended (again)
    NEXT_HOLD = 17  # samples; length of the next hold
    SLOW = 18  # factor on the paces after harm, 1 to 8
    INSTRUCTIVE = 19  # 1: the attempt was such that it shows the error of the model
    PROVEN = 20  # 1: the voltage has calmed the strut since it last was the cause
    BRIEF = 21  # 1: this hold ends as soon as the power at 0 V is the larger one


class Correction(IntEnum):
    """Places in `correction`, the correction of the model; `model_correction` writes them."""

    F_0 = 0  # coefficients of the correcting filter f_0 + f_1 z^-1
    F_1 = 1
    CORRECTED_AT = 2  # rad/sample; where; 0: the model is as it was identified
    LAST_EFFECT = 3  # m/s^2; of the sample before, without the correction
    OMEGA = 4  # rad/sample; frequency of the attempt; 0: no attempt so far
    STRAYED = 5  # rad/sample; farthest that the frequency went away from it
    TURN = 6  # rad; by which the next sample is turned back
    ONE = 7  # 1, smoothed
    Y_RE = 8  # m/s^2; y, turned back and smoothed
    Y_IM = 9
    V_RE = 10  # m/s^2; G u, turned back and smoothed
    V_IM = 11
    SS = 12  # sums of products over the memory: S with S, S with V, S with Y, V with V, V with Y, Y with Y
    SV_RE = 13
    SV_IM = 14
    SY_RE = 15
    SY_IM = 16
    VV = 17
    VY_RE = 18
    VY_IM = 19
    YY = 20


UNCORRECTED = np.eye(len(Correction))[Correction.F_0]  # the model as it was identified


class Ring(IntEnum):
    """Rows of `rings`, the last samples."""

    ERROR = 0  # m/s^2; e of the tracker
    DISTURBANCE = 1  # m/s^2; d


class Floor(IntEnum):
    """Rows of `floor`, by frequency."""

    NOISE = 0  # (m/s^2)^2; noise floor
    MEAN = 1  # (m/s^2)^2; mean of P over eight windows
    SQUARE = 2  # (m/s^2)^4; mean of P^2


class Past(IntEnum):
    """Columns of `past`, the strut's last seconds."""

    UPPER = 0  # m/s^2; y
    APPLIED = 1  # V; voltage before it
    VALID = 2  # 1: measured, 0: not measured, -1: there was no such sample


class Point(IntEnum):
    """Columns of `points`, where the sensitivity is watched."""

    OMEGA = 0  # rad/sample
    RE = 1  # m/s^2/V; response of the model
    IM = 2
    PARTNERS = 3  # |S| of the loops beside this one, at least 1


class Weight(IntEnum):
    """Columns of `weights`, by which a tone's voltage is multiplied to serve the payload between the samples."""

    OMEGA = 0  # rad/sample
    RE = 1
    IM = 2


class Shown(IntEnum):
    """Places in `shown`, what a step shows."""

    ERROR = 0  # m/s^2; e
    OMEGA = 1  # rad/sample; frequency of the strongest tone; NaN: none
    VOLTS = 2  # V; amplitudes of the voltage together
    SENSITIVITY = 3  # max |S| on the model
    TRACKING = 4  # 1: a tone is tracked
    LIMITED = 5  # 1: the voltage limit does not cancel all tones
    HELD = 6  # 1: the law is held at 0 V
    SLOWED = 7  # 1: slower than wanted for the margin


class Design(NamedTuple):
    """What a model and the settings give; a kernel does not change it.

    Attributes:
        b, a: (m) polynomials of the model in z^-1, V to m/s^2.
        settings: (Setting).
        points: (q, Point).
        weights: (w, Weight), by increasing frequency; one row: none.
    """

    b: Array
    a: Array
    settings: Array
    points: Array
    weights: Array


class Memory(NamedTuple):
    """What is kept from sample to sample; changed in place.

    Attributes:
        model: (m - 1) state of the model's filter.
        tracking: (Tracking).
        backoff: (Backoff).
        correction: (Correction).
        tones: (tones, Tone).
        rings: (Ring, window).
        floor: (Floor, frequencies).
    """

    model: Array
    tracking: Array
    backoff: Array
    correction: Array
    tones: Array
    rings: Array
    floor: Array

    @classmethod
    def at_rest(
        cls, shape: tuple[int, ...], model: Array, tones: int, window: int, frequencies: int
    ) -> 'Memory':
        """Give the memory of a law that has heard nothing, with the state of its model's filter (*shape, m - 1)."""
        tracking = np.zeros((*shape, len(Tracking)))
        tracking[..., Tracking.STRETCH] = 1.0
        backoff = np.zeros((*shape, len(Backoff)))
        backoff[..., Backoff.SLOW] = 1.0
        return cls(
            model=model,
            tracking=tracking,
            backoff=backoff,
            correction=np.tile(UNCORRECTED, (*shape, 1)),
            tones=np.zeros((*shape, tones, len(Tone))),
            rings=np.zeros((*shape, len(Ring), window)),
            floor=np.zeros((*shape, len(Floor), frequencies)),
        )


class Sample(NamedTuple):
    """What a step is given.

    Attributes:
        y: m/s^2; upper acceleration.
        applied: V; between the sample before and this one.
        valid: y was measured.
        act: the law's voltage is used.
    """

    y: float
    applied: float
    valid: bool
    act: bool
