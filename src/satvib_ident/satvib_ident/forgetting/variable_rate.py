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
from numpy.typing import NDArray
from satvib_common.errors import SatvibError
from satvib_common.kernel import kernel
from scipy.special import fdtri

from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Factors

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@kernel(
    'void(f8, b1, f8, f8, f8[:], f8[:], f8[:])',
    '(),(),(),(),(w),(s)->()',
    writable=('ring', 'state'),
)
def _ratio(square, active, short, floor, ring, state, out):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Push e^2 and give F; 0 until the windows are full.

    `state`: samples held, next place, sum of the short window, sum of the long one.
    """
    size = ring.shape[0]
    n = int(short)
    held = int(state[0])
    place = int(state[1])
    if active:
        middle = (place - n) % size
        if held >= n:
            state[2] -= ring[middle]
            state[3] += ring[middle]
        if held == size:
            state[3] -= ring[place]
        ring[place] = square
        state[2] += square
        held = min(held + 1, size)
        place = (place + 1) % size
        state[0] = held
        state[1] = place
        if place == 0 and held == size:  # once a round, wash out what rounding has left behind
            state[2] = 0.0
            state[3] = 0.0
            for k in range(size - n):
                state[3] += ring[k]
            for k in range(size - n, size):
                state[2] += ring[k]
    out[0] = 0.0
    if held == size:
        recent = max(state[2], 0.0) / n
        before = max(state[3], 0.0) / (size - n)
        out[0] = recent / max(before, floor)


class VariableRateForgetting(NoForgetting):
    """The F test decides.

    Args:
        short: samples of the recent window.
        long: samples of the window before it.
        confidence: probability that nothing is forgotten at one sample while nothing changes, in (0, 1).
        rate: eta, how fast to forget when the test says so.
        smallest: lambda_min in (0, 1].
        floor: m/s^2; errors below it count as it, so that rounding is not taken for change.
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
        self._floor = floor * floor

    def bind(self, estimator: Factors) -> None:
        """Make the windows."""
        self._ring = np.zeros((*estimator.shape, self.short + self.long))
        self._state = np.zeros((*estimator.shape, 4))

    def apply(
        self,
        estimator: Factors,  # noqa: ARG002
        w: Array,  # noqa: ARG002
        error: Array,
        active: Mask,
    ) -> tuple[Array | float, Array, Mask]:
        """Test, and forget as far as the test says."""
        square = np.minimum(np.abs(error), 1e100)
        ratio = _ratio(square * square, active, self.short, self._floor, self._ring, self._state)
        excess = np.maximum(np.sqrt(ratio) - self.threshold, 0.0)
        return np.maximum(1.0 / (1.0 + self.rate * excess), self.smallest), error, active

    def reset(self, mask: Mask) -> None:
        """Empty the windows."""
        self._state[...] = np.where(mask[..., None], 0.0, self._state)
