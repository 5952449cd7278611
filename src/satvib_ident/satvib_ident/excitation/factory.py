# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Excitation signals by name."""

import difflib
from typing import Any

from satvib_common.errors import SatvibError

from satvib_ident.excitation.band_random import BandRandom
from satvib_ident.excitation.chirp import Chirp
from satvib_ident.excitation.multisine import Multisine
from satvib_ident.excitation.prbs import Prbs
from satvib_ident.excitation.signal import Excitation
from satvib_ident.excitation.sines import Sines
from satvib_ident.excitation.squares import Squares

SIGNALS: dict[str, type[Excitation]] = {
    'squares': Squares,
    'sines': Sines,
    'prbs': Prbs,
    'multisine': Multisine,
    'chirp': Chirp,
    'random': BandRandom,
}


def make_excitation(name: str, **options: Any) -> Excitation:
    """Make a signal.

    Args:
        name: a key of `SIGNALS`.
        options: the fields of that signal: amplitude (V) and dt (s) always; strut, struts, seed and its own if
        wanted.

    Raises:
        SatvibError: an unknown name or option, or a value that the signal cannot have.
    """
    if name not in SIGNALS:
        close = difflib.get_close_matches(name, SIGNALS, n=1)
        hint = f'did you mean {close[0]}?' if close else f'known: {", ".join(SIGNALS)}'
        raise SatvibError(f'excitation: {name!r} is unknown; {hint}')
    return SIGNALS[name].from_mapping(options, f'excitation {name}')
