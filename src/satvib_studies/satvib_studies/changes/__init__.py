# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a law does when the rig changes under it: drawn changes in CONTROL, judged by the open loop of the same rig."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.changes.drawing import KINDS, Change, draw_change
    from satvib_studies.changes.runs import Outcome, count_stops, run_changes

__all__ = ['KINDS', 'Change', 'Outcome', 'count_stops', 'draw_change', 'run_changes']
__getattr__, __dir__ = door(__name__, __file__)
