# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The law `state_space`: a fixed linear controller, its matrices as parameters, for one strut or for all at once."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.laws.state_space.law import StateSpace
    from satvib_control.laws.state_space.matrices import Matrices, matrices_of, response
    from satvib_control.laws.state_space.parameters import StateSpaceParameters

__all__ = [
    'Matrices',
    'StateSpace',
    'StateSpaceParameters',
    'matrices_of',
    'response',
]
__getattr__, __dir__ = door(__name__, __file__)
