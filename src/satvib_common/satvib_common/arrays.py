# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The kinds of arrays, for annotations. Shapes and units stand in each docstring."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


def some(mask: Mask) -> bool:
    """Whether a mask of any shape holds somewhere; for one strut without NumPy's way of adding up."""
    return bool(mask.any()) if mask.ndim else bool(mask)


def every(mask: Mask) -> bool:
    """Whether a mask of any shape holds everywhere."""
    return bool(mask.all()) if mask.ndim else bool(mask)
