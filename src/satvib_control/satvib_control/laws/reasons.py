# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Why a law does not act or does not adapt: texts as small numbers, so that an array can hold one per item.

0 is the empty text: there is nothing to say.
"""

import re
from collections.abc import Iterable

import numpy as np
from satvib_common.arrays import Array, Integers, Mask

_TEXTS: list[str] = ['']
_CODES: dict[str, int] = {'': 0}
_FIGURE = re.compile(r'\d[\d.e+-]*')


def reason(text: str) -> int:
    """Give the code of a text; the same text has the same code for the life of the process."""
    if text not in _CODES:
        _CODES[text] = len(_TEXTS)
        _TEXTS.append(text)
    return _CODES[text]


def text_of(code: int) -> str:
    """Give the text of a code."""
    return _TEXTS[int(code)]


def shown(values: Array) -> str:
    """Give figures (shape) for a line of text, of several struts with a stroke between them."""
    return ' / '.join(f'{value:.4g}' for value in np.ravel(values))


def reasons(texts: str | Iterable[str], shape: tuple[int, ...]) -> Integers:
    """Codes (shape) of one text for all, or of texts with that shape in C order (any nesting)."""
    array = np.asarray(texts, dtype=object)
    flat = [reason(str(text)) for text in array.ravel()]
    return np.broadcast_to(np.array(flat, dtype=np.int64).reshape(array.shape), shape).copy()


class ForeignTexts:
    """Texts of messages, of which only so many get a code in a process: another node writes a new one every second.

    Args:
        most: as they are; half as many get a code without their figures, and all others have one in common.
    """

    def __init__(self, most: int = 1000) -> None:
        self._most = most
        self._known: set[str] = set()

    def take(self, text: str) -> str:
        """Give the text as it is shown."""
        for candidate, most in (
            (text, self._most),
            (_FIGURE.sub('...', text), self._most + self._most // 2),
        ):
            if candidate in self._known or len(self._known) < most:
                self._known.add(candidate)
                return candidate
        return 'one of many reasons; see the message identified_model'


def last_of(why: Integers, *cases: tuple[Mask, int]) -> Integers:
    """Give the code of the last case that holds, `why` where none does.

    Args:
        why: shape, codes; or one for all.
        cases: (shape) where a code holds, and the code; the most important one last.
    """
    if not cases[0][0].ndim:  # one strut: every `where` would cost more than all of these
        for case, code in cases:
            if case:
                why = np.int64(code)  # type: ignore[assignment]
        return np.asarray(why)
    for case, code in cases:
        why = np.where(case, code, why)
    return why
