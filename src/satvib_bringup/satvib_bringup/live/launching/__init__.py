# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The launch files: which processes each starts, and how they end together."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.live.launching.member import Member
    from satvib_bringup.live.launching.plans import PLANS, Plan

__all__ = ['PLANS', 'Member', 'Plan']
__getattr__, __dir__ = door(__name__, __file__)
