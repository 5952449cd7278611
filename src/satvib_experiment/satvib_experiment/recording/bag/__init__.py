# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The files of a bag, whole, cut or damaged: their messages, and what is to be said about them."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.recording.bag.files import BagContent, find_bag, read_bag
    from satvib_experiment.recording.bag.mcap_file import McapFile
    from satvib_experiment.recording.bag.sqlite_file import SqliteFile

__all__ = ['BagContent', 'McapFile', 'SqliteFile', 'find_bag', 'read_bag']
__getattr__, __dir__ = door(__name__, __file__)
