# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The motions of the payload at its struts (the paper's Fig. 1).

    w_i = w + y_i alpha - x_i beta = w + sin(t_i) alpha_r - cos(t_i) beta_r,    alpha_r = r alpha, beta_r = r beta

t_i is the angle of strut i on the circle of radius r. alpha_r and beta_r are the tilts as the motion that they make at
that circle: then all three motions have the unit of w, and no radius is needed.
"""

import math
from collections.abc import Sequence

import numpy as np

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError


def motion_matrix(angles: Sequence[float], radius: float = 1.0) -> Array:
    """Give S (n, 3) with (w_1 .. w_n) = S (w, alpha, beta); `angles` in rad, `radius` in m."""
    return np.array([[1.0, radius * math.sin(t), -radius * math.cos(t)] for t in angles])


def strut_matrix(angles: Sequence[float]) -> Array:
    """Give T (n, n) with (w_1 .. w_n) = T (w, alpha_r, beta_r); `angles` in degrees, one or three.

    Raises:
        SatvibError: two of three struts stand in one place.
    """
    if len(angles) == 1:
        return np.ones((1, 1))
    matrix = motion_matrix([math.radians(a) for a in angles])
    if abs(np.linalg.det(matrix)) < 1e-3:
        raise SatvibError(
            f'strut_angles: {", ".join(f"{a:g}" for a in angles)} deg are not three places'
        )
    return matrix


def mode_matrix(angles: Sequence[float]) -> Array:
    """Give the inverse of `strut_matrix` (n, n)."""
    return np.asarray(np.linalg.inv(strut_matrix(angles)))
