# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a message suggests in the place of a name that is not known."""

import difflib
from collections.abc import Sequence

_MOST = 60  # names in a line


def nearest(name: str, known: Sequence[str]) -> str:
    """Suggest the nearest known name, and list all, or the first 60."""
    close = difflib.get_close_matches(name, known, n=1)
    more = f' and {len(known) - _MOST} more' if len(known) > _MOST else ''
    listed = f'known: {", ".join(known[:_MOST])}{more}'
    return f'did you mean {close[0]}? ({listed})' if close else listed
