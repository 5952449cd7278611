# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Names that become names of folders."""

from satvib_common.errors import SatvibError, printable

_LONGEST = 200  # bytes; a file system takes 255, and a number follows


def check_folder_name(name: str, where: str = 'name') -> None:
    """Refuse a name that cannot be part of a folder name.

    Args:
        name: what is to be in the folder's name.
        where: what begins the message.

    Raises:
        SatvibError: it is empty, '.' or '..', too long, or holds a slash, a blank, a control character or half a
            character.
    """
    fits = (
        name not in {'', '.', '..'}
        and name.isprintable()
        and not set(name) & set('/\\ ')
        and len(name.encode('utf-8', 'replace')) <= _LONGEST
    )
    if not fits:
        raise SatvibError(f'{where}: {printable(repr(name), 60)} cannot be part of a folder name')
