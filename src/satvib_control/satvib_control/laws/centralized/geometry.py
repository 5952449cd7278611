# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""From the motions of the payload (the paper's Fig. 1) to those of its struts, and back.

    w_i = w + sin(t_i) alpha_r - cos(t_i) beta_r,    alpha_r = r alpha, beta_r = r beta

t_i is the angle of strut i; the tilts are taken as the motion that they make at the circle of radius r, so that all
three have the unit of w, and no radius is needed.
"""

import math
from collections.abc import Sequence

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError


def strut_matrix(angles: Sequence[float]) -> Array:
    """Give T (n, n) with (w_1 .. w_n) = T (w, alpha_r, beta_r); `angles` in degrees, one or three.

    Raises:
        SatvibError: two of three struts stand in one place.
    """
    if len(angles) == 1:
        return np.ones((1, 1))
    t = [math.radians(a) for a in angles]
    matrix = np.array([[1.0, math.sin(a), -math.cos(a)] for a in t])
    if abs(np.linalg.det(matrix)) < 1e-3:
        raise SatvibError(
            f'strut_angles: {", ".join(f"{a:g}" for a in angles)} deg are not three places'
        )
    return matrix


def mode_matrix(angles: Sequence[float]) -> Array:
    """Give the inverse of `strut_matrix` (n, n)."""
    return np.asarray(np.linalg.inv(strut_matrix(angles)))
