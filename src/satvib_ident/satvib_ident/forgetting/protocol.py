# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What every forgetting rule offers to an estimator."""

from typing import Protocol

from satvib_common.arrays import Array, Mask


class Factors(Protocol):
    """What a rule may see and change of an estimator; errors come times `error_scale` (1 but for weighted samples)."""

    count: int
    shape: tuple[int, ...]
    theta: Array
    U: Array
    d: Array
    limit: Array
    error_scale: Array | float

    def reset_covariance(self, mask: Mask | bool = True) -> None:
        """P <- P(0) where `mask` (shape) holds."""


class Forgetting(Protocol):
    """A rule that looks at each sample before the estimator uses it."""

    def bind(self, estimator: Factors) -> None:
        """Make room for the estimator's shape; called once."""

    def apply(
        self, estimator: Factors, w: Array, error: Array, active: Mask
    ) -> tuple[Array, Array, Mask]:
        """Change the factors if the rule says so, before the measurement.

        Args:
            estimator: the factors.
            w: (*shape, p) regressor of the gain.
            error: (shape) prediction error.
            active: (shape) whether the sample is to be used.

        Returns:
            lambda (shape or ()) for the measurement, the prediction error (shape; another one if the rule has
            moved the estimate), and whether the sample is still to be used (shape).
        """

    def know_noise(self, deviation: Array) -> None:
        """Take the deviation (shape) of the noise on the output; 0 where it is not known."""

    def reset(self, mask: Mask) -> None:
        """Forget the rule's own memory where `mask` (shape) holds."""
