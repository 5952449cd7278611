# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Files that are read or written, and what a message suggests for a wrong name."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.files.disk import disk_complaint, room_at
    from satvib_common.files.npz_file import load_npz_arrays
    from satvib_common.files.suggestions import nearest
    from satvib_common.files.whole_file import write_whole

__all__ = ['disk_complaint', 'load_npz_arrays', 'nearest', 'room_at', 'write_whole']
__getattr__, __dir__ = door(__name__, __file__)
