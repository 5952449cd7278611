# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The errors that people see, in one line each."""

_LONGEST = 4000  # characters of an error


class _OneLineError(Exception):
    """An error whose text a terminal may show, also where it quotes a damaged file."""

    def __str__(self) -> str:
        return printable(super().__str__(), _LONGEST)


class SatvibError(_OneLineError):
    """A wrong input or set-up. Its text is one line: what, where, and what to do.

    Commands print it as it is and exit with 2. Anything else that escapes is a defect of satvib.
    """


class RunError(_OneLineError):
    """A run that started and then failed. Its text is one line. Commands exit with 1."""


def printable(text: str, longest: int = 2000) -> str:
    """Give a text as one line that a terminal may show: control characters as escapes, cut where it is too long."""
    if len(text) > longest:
        text = f'{text[: longest - 4]} ...'
    if text.isprintable():
        return text
    return ''.join(c if c.isprintable() else c.encode('unicode_escape').decode() for c in text)
