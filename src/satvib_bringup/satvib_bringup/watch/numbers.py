# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers as a page gets them: four digits, and null in the place of what JSON has no word for."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np


def short(value: Any) -> Any:
    """Shorten a number, or each number of a list, an array or an array type; None where it is not finite."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [short(item) for item in value]
    if isinstance(value, float):
        return float(f'{value:.4g}') if math.isfinite(value) else None
    return value
