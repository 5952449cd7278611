# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an accelerometer can have measured: a number that no sensor gives counts as one that is missing.

A single reading of 1e300 m/s^2 would stay in an integrator for hundreds of its time constants.
"""

import math

# m/s^2, a thousand times the acceleration of the earth; sensors of a vibration isolator end far below it
LARGEST = 1e4
# of a signal in any unit: above it the sums of an estimator overflow
ABSURD = 1e12


def possible(value: float, largest: float = LARGEST) -> float:
    """Give the reading (m/s^2), or NaN when its magnitude is more than `largest` or it is no number."""
    return value if -largest <= value <= largest else math.nan
