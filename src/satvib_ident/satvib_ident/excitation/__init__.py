# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Excitation signals by name and sample index."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.excitation.band_random import BandRandom
    from satvib_ident.excitation.chirp import Chirp
    from satvib_ident.excitation.factory import SIGNALS, make_excitation
    from satvib_ident.excitation.multisine import Multisine
    from satvib_ident.excitation.prbs import Prbs
    from satvib_ident.excitation.signal import Excitation
    from satvib_ident.excitation.sines import Sines
    from satvib_ident.excitation.squares import Squares

__all__ = [
    'SIGNALS',
    'BandRandom',
    'Chirp',
    'Excitation',
    'Multisine',
    'Prbs',
    'Sines',
    'Squares',
    'make_excitation',
]
__getattr__, __dir__ = door(__name__, __file__)
