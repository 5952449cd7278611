# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an estimator does with old data: one file per rule."""

from satvib_ident.forgetting.exponential import ExponentialForgetting
from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Forgetting

__all__ = ['ExponentialForgetting', 'Forgetting', 'NoForgetting']
