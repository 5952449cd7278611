# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How much room a disk has, and errors of the disk that are nobody's defect."""

import errno
import os
from pathlib import Path

# the machine is in the way: no room, over quota, read-only, out of order
_OF_THE_MACHINE = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO, errno.EFBIG}
MEGABYTE = 1_000_000


def room_at(folder: Path) -> int:
    """Bytes that may still be written where a folder is, or will be."""
    place = folder.absolute()
    while not place.exists():
        place = place.parent
    found = os.statvfs(place)
    return found.f_bavail * found.f_frsize


def disk_complaint(error: OSError) -> str:
    """Give the line for an error of the disk, or an empty text for any other error."""
    if error.errno not in _OF_THE_MACHINE:
        return ''
    where = f'{error.filename}: ' if error.filename else ''
    advice = '; make room, then run the command again' if error.errno == errno.ENOSPC else ''
    return f'{where}cannot be written: {error.strerror}{advice}'
