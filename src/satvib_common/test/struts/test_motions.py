# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Names and places of the struts."""

import math

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.struts.motions import mode_matrix, strut_matrix
from satvib_common.struts.names import strut_angles, strut_names


def test_the_modes_of_three_struts_are_those_of_the_drawing():
    """Truth: the paper's Fig. 1 by hand: a tilt about x moves y by y alpha, one about y moves x by -x beta."""
    angles = (90.0, 210.0, 330.0)
    r, heave, alpha, beta = 0.15, 0.3, 0.02, -0.05
    places = [(r * math.cos(math.radians(a)), r * math.sin(math.radians(a))) for a in angles]
    moved = np.array([heave + y * alpha - x * beta for x, y in places])
    assert mode_matrix(angles) @ moved == pytest.approx([heave, r * alpha, r * beta], abs=1e-15)
    assert mode_matrix(angles) @ strut_matrix(angles) == pytest.approx(np.eye(3), abs=1e-15)
    with pytest.raises(SatvibError, match='not three places'):
        strut_matrix((0.0, 0.0, 120.0))


def test_struts_are_numbered_from_one_and_spread_evenly():
    """Truth: by hand."""
    assert strut_names(3) == ('strut_1', 'strut_2', 'strut_3')
    assert strut_angles(3, 90.0) == [90.0, 210.0, 330.0]
    assert strut_angles(1, 30.0) == [30.0]
