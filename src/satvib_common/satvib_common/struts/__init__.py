# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The struts: names, places on the circle, what became of their voltages, and the motions of the payload there."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.struts.applied import Applied, Pace
    from satvib_common.struts.motions import mode_matrix, motion_matrix, strut_matrix
    from satvib_common.struts.names import strut_angles, strut_names

__all__ = [
    'Applied',
    'Pace',
    'mode_matrix',
    'motion_matrix',
    'strut_angles',
    'strut_matrix',
    'strut_names',
]
__getattr__, __dir__ = door(__name__, __file__)
