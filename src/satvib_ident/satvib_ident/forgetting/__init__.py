# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an estimator does with old data: one file per rule."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.forgetting.dead_zone import DeadZone
    from satvib_ident.forgetting.directional import DirectionalForgetting
    from satvib_ident.forgetting.exponential import ExponentialForgetting
    from satvib_ident.forgetting.none import NoForgetting
    from satvib_ident.forgetting.protocol import Forgetting
    from satvib_ident.forgetting.resetting import CovarianceResetting
    from satvib_ident.forgetting.variable_rate import VariableRateForgetting
    from satvib_ident.forgetting.window import FiniteWindow

__all__ = [
    'CovarianceResetting',
    'DeadZone',
    'DirectionalForgetting',
    'ExponentialForgetting',
    'FiniteWindow',
    'Forgetting',
    'NoForgetting',
    'VariableRateForgetting',
]
__getattr__, __dir__ = door(__name__, __file__)
