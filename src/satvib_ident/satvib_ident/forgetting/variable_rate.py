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

import numpy as np
from numba import njit
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from scipy.special import fdtri

from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Factors


@njit(inline='always')
def push_square(error, n, ring, state):
    """Push e^2 into the windows, the recent one of n.

    `state`: samples held, next place, sum of the short window, sum of the long one.
    """
    size = ring.shape[0]
    held = int(state[0])
    place = int(state[1])
    square = min(abs(error), 1e100)
    square *= square
    middle = place - n
    if middle < 0:
        middle += size
    if held >= n:
        state[2] -= ring[middle]
        state[3] += ring[middle]
    if held == size:
        state[3] -= ring[place]
    ring[place] = square
    state[2] += square
    held = min(held + 1, size)
    place += 1
    if place == size:
        place = 0
    state[0] = held
    state[1] = place
    if place == 0:  # once a round, wash out what rounding has left behind
        state[2] = 0.0
        state[3] = 0.0
        for k in range(size - n):
            state[3] += ring[k]
        for k in range(size - n, size):
            state[2] += ring[k]


@njit(inline='always')
def tested_factor(error, active, settings, ring, state):
    """Push an error where active, and give lambda; `settings` as in `VariableRateForgetting.settings`."""
    size = ring.shape[0]
    n = int(settings[0])
    if active:
        push_square(error, n, ring, state)
    ratio = 0.0
    if int(state[0]) == size:
        recent = max(state[2], 0.0) / n
        before = max(state[3], 0.0) / (size - n)
        ratio = recent / max(before, settings[4])
    excess = max(np.sqrt(ratio) - settings[1], 0.0)
    return max(1.0 / (1.0 + settings[2] * excess), settings[3])


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
        floor: m/s^2; errors below it count as it, so that rounding is not taken for change.

    Attributes:
        settings: what the kernels need: short, sqrt(F*), rate, smallest, floor squared.
        ring, state: the windows, (*shape, short + long) and (*shape, 4); `directional` looks at them too.
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
        self.threshold = math.sqrt(float(fdtri(short, long, confidence)))
        self.settings = np.array([short, self.threshold, rate, smallest, floor * floor])

    def bind(self, estimator: Factors) -> None:
        """Make the windows."""
        # items lie side by side: they are mostly at the same place of their windows
        self.ring = np.moveaxis(np.zeros((self.short + self.long, *estimator.shape)), 0, -1)
        self.state = np.zeros((*estimator.shape, 4))

    def apply(
        self,
        estimator: Factors,  # noqa: ARG002
        w: Array,  # noqa: ARG002
        error: Array,
        active: Mask,
    ) -> tuple[Array, Array, Mask]:
        """Test, and forget as far as the test says."""
        return _factor(error, active, self.settings, self.ring, self.state), error, active

    def reset(self, mask: Mask) -> None:
        """Empty the windows."""
        self.state[...] = np.where(mask[..., None], 0.0, self.state)
