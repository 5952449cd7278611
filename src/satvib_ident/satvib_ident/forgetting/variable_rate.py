# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Variable-rate forgetting: forget only when recent errors are significantly larger than those before.

    F(k) = mean of e^2 over the last s samples / mean of e^2 over the l samples before them
    lambda(k) = 1 / (1 + eta max(0, sqrt(F) - sqrt(F*))),  not below lambda_min

F* is the quantile of the F distribution with (s, l) degrees of freedom: as long as nothing has changed, F stays
below it with the chosen confidence and nothing is forgotten, whatever the level of the noise. Only samples that are
used count, so silence neither fills nor empties the windows.

N. Mohseni and D. S. Bernstein, Recursive least squares with variable-rate forgetting based on the F-test, American
Control Conference 2022. There both windows end at k; here they do not overlap, as the test asks.
"""

import math
from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.special import f_below

from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Factors


class Setting(IntEnum):
    """Places of the settings of the test."""

    SHORT = 0  # samples of the recent window
    THRESHOLD = 1  # sqrt(F*)
    RATE = 2  # eta
    SMALLEST = 3  # lambda_min
    FLOOR = 4  # m^2/s^4, smallest mean square


class Windows(IntEnum):
    """Places of the state of the two windows."""

    HELD = 0  # samples
    NEXT = 1  # place of the next one
    SHORT_SUM = 2  # sum of squares of the recent window
    LONG_SUM = 3  # of the window before it


@njit(inline='always')
def push_square(error, n, ring, state):
    """Push e^2 into the windows (`state`: see `Windows`), the recent one of n."""
    size = ring.shape[0]
    held = int(state[Windows.HELD])
    place = int(state[Windows.NEXT])
    square = min(abs(error), 1e100)
    square *= square
    middle = place - n
    if middle < 0:
        middle += size
    if held >= n:
        state[Windows.SHORT_SUM] -= ring[middle]
        state[Windows.LONG_SUM] += ring[middle]
    if held == size:
        state[Windows.LONG_SUM] -= ring[place]
    ring[place] = square
    state[Windows.SHORT_SUM] += square
    held = min(held + 1, size)
    place += 1
    if place == size:
        place = 0
    state[Windows.HELD] = held
    state[Windows.NEXT] = place
    if place == 0:  # once a round, add up again without the rounding errors
        state[Windows.SHORT_SUM] = 0.0
        state[Windows.LONG_SUM] = 0.0
        for k in range(size - n):
            state[Windows.LONG_SUM] += ring[k]
        for k in range(size - n, size):
            state[Windows.SHORT_SUM] += ring[k]


@njit(inline='always')
def tested_factor(error, active, settings, ring, state):
    """Push an error where active, and give lambda; `settings` as in `VariableRateForgetting.settings`."""
    size = ring.shape[0]
    n = int(settings[Setting.SHORT])
    if active:
        push_square(error, n, ring, state)
    ratio = 0.0
    if int(state[Windows.HELD]) == size:
        recent = max(state[Windows.SHORT_SUM], 0.0) / n
        before = max(state[Windows.LONG_SUM], 0.0) / (size - n)
        ratio = recent / max(before, settings[Setting.FLOOR])
    excess = max(np.sqrt(ratio) - settings[Setting.THRESHOLD], 0.0)
    return max(1.0 / (1.0 + settings[Setting.RATE] * excess), settings[Setting.SMALLEST])


@kernel(
    'void(f8, b1, f8[:], f8[:], f8[:], f8[:])',
    '(),(),(c),(w),(s)->()',
    writable=('ring', 'state'),
)
def _factor(error, active, settings, ring, state, out):
    out[0] = tested_factor(error, active, settings, ring, state)


class VariableRateForgetting(NoForgetting):
    """The F test decides.

    Args:
        short: samples of the recent window.
        long: samples of the window before it.
        confidence: probability that nothing is forgotten at one sample while nothing changes, in (0, 1).
        rate: eta, how fast to forget when the test says so.
        smallest: lambda_min in (0, 1].
        floor: m/s^2; smaller errors count as this, so that rounding is not taken for a change.

    Attributes:
        settings: (5) of the kernels, see `Setting`.
        ring, state: the windows, (*shape, short + long), and (*shape, 4), see `Windows`; `directional` uses them too.
    """

    def __init__(
        self,
        short: int = 20,
        long: int = 100,
        confidence: float = 0.999,
        rate: float = 1.0,
        smallest: float = 0.5,
        floor: float = 1e-6,
    ) -> None:
        if short < 1 or long < 1:
            raise SatvibError(f'variable-rate forgetting: windows of {short} and {long} samples')
        if not 0.0 < confidence < 1.0:
            raise SatvibError(f'variable-rate forgetting: confidence {confidence} is not in (0, 1)')
        if not 0.0 < smallest <= 1.0:
            raise SatvibError(f'variable-rate forgetting: lambda_min {smallest} is not in (0, 1]')
        self.short, self.long, self.rate, self.smallest = short, long, rate, smallest
        self.threshold = math.sqrt(f_below(short, long, confidence))
        self.settings = np.zeros(len(Setting))
        self.settings[Setting.SHORT] = short
        self.settings[Setting.THRESHOLD] = self.threshold
        self.settings[Setting.RATE] = rate
        self.settings[Setting.SMALLEST] = smallest
        self.settings[Setting.FLOOR] = floor * floor

    def bind(self, estimator: Factors) -> None:
        """Make the windows."""
        # items lie side by side: they are mostly at the same place of their windows
        self.ring = np.moveaxis(np.zeros((self.short + self.long, *estimator.shape)), 0, -1)
        self.state = np.zeros((*estimator.shape, len(Windows)))

    def apply(
        self,
        estimator: Factors,  # noqa: ARG002
        w: Array,  # noqa: ARG002
        error: Array,
        active: Mask,
    ) -> tuple[Array, Array, Mask]:
        """Test, and forget as much as the test says."""
        return _factor(error, active, self.settings, self.ring, self.state), error, active

    def reset(self, mask: Mask) -> None:
        """Empty the windows."""
        self.state[...] = np.where(mask[..., None], 0.0, self.state)
