# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The uses of a trial's seed: each draws from `default_rng([seed, stream, ...])`, so that none changes another."""

from enum import IntEnum


class Stream(IntEnum):
    """What is drawn."""

    BIAS = 0
    NOISE = 1
    DISTURBANCE = 2
