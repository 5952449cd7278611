# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A supervisor over all struts, which no strut needs: it finds the one that makes the others loud, and stops it."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.supervision.hold import Hold
    from satvib_control.supervision.parameters import SupervisorParameters
    from satvib_control.supervision.supervisor import (
        Ask,
        SupervisorCore,
        ask,
        check_period,
        is_checked,
    )

__all__ = [
    'Ask',
    'Hold',
    'SupervisorCore',
    'SupervisorParameters',
    'ask',
    'check_period',
    'is_checked',
]
__getattr__, __dir__ = door(__name__, __file__)
