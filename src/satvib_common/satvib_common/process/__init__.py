# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How processes begin, so that a signal ends them cleanly at every moment, and how several share a piece of work."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.process.parallel import cores, run_in_processes
    from satvib_common.process.start import start_with_blocked_signals, starter

__all__ = ['cores', 'run_in_processes', 'start_with_blocked_signals', 'starter']
__getattr__, __dir__ = door(__name__, __file__)
