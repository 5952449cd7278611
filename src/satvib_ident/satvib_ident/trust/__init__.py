# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a model is trusted: measures of excitation, residual and response, and the checks on them."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.trust.checks import Check, Trust, judge
    from satvib_ident.trust.measures import RecentSignal
    from satvib_ident.trust.model_error import ModelError
    from satvib_ident.trust.response_deviation import ResponseDeviation

__all__ = [
    'Check',
    'ModelError',
    'RecentSignal',
    'ResponseDeviation',
    'Trust',
    'judge',
]
__getattr__, __dir__ = door(__name__, __file__)
