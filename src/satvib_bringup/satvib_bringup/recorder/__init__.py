# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Writing a bag: messages as they came, their definitions, and what a killed recorder left."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.recorder.bag_sink import BagSink, open_bag
    from satvib_bringup.recorder.check import Expected, complaint, read_report
    from satvib_bringup.recorder.salvage import is_finished

__all__ = [
    'BagSink',
    'Expected',
    'complaint',
    'is_finished',
    'open_bag',
    'read_report',
]
__getattr__, __dir__ = door(__name__, __file__)
