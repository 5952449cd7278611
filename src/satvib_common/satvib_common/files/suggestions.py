# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a message suggests in the place of a name that is not known."""

import difflib
from collections.abc import Sequence


def nearest(name: str, known: Sequence[str]) -> str:
    """Suggest the nearest known name, and list all."""
    close = difflib.get_close_matches(name, known, n=1)
    listed = f'known: {", ".join(known)}'
    return f'did you mean {close[0]}? ({listed})' if close else listed
