# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The struts: their names, their places on the circle, and the motions of the payload there."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.struts.motions import mode_matrix, motion_matrix, strut_matrix
    from satvib_common.struts.names import strut_angles, strut_names

__all__ = ['mode_matrix', 'motion_matrix', 'strut_angles', 'strut_matrix', 'strut_names']
__getattr__, __dir__ = door(__name__, __file__)
