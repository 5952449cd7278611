# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is asked of the nodes of a running graph: their services and their parameters."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.live.services.caller import Caller
    from satvib_bringup.live.services.remote import Remote

__all__ = ['Caller', 'Remote']
__getattr__, __dir__ = door(__name__, __file__)
