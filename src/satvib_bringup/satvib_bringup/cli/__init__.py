# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The command `satvib`: one file per subcommand in `commands`, and what they print."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.cli.console import ProgressView, make_console, show_result
    from satvib_bringup.cli.identification_view import show_identification

__all__ = [
    'ProgressView',
    'make_console',
    'show_identification',
    'show_result',
]
__getattr__, __dir__ = door(__name__, __file__)
