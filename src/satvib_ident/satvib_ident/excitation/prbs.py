# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Pseudo-random binary sequence: maximal-length, with a chosen clock and register length.

    u = +-amplitude, a new bit every `clock` samples, period (2^order - 1) clock samples

Its crest factor is 1, the best there is, and its spectrum is flat up to about 0.4 / (clock dt). Strut s starts s /
struts of a period later, where the sequence is uncorrelated with itself.

Feedback taps of primitive polynomials: S. W. Golomb, Shift Register Sequences, 1967.
"""

from dataclasses import dataclass
from functools import cached_property

from satvib_common.schema import param

from satvib_ident.excitation.signal import Excitation

# order: stages whose sum modulo 2 is fed back
TAPS = {
    3: (3, 2),
    4: (4, 3),
    5: (5, 3),
    6: (6, 5),
    7: (7, 6),
    8: (8, 6, 5, 4),
    9: (9, 5),
    10: (10, 7),
    11: (11, 9),
    12: (12, 11, 10, 4),
    13: (13, 12, 11, 8),
    14: (14, 13, 12, 2),
    15: (15, 14),
    16: (16, 15, 13, 4),
}


@dataclass(frozen=True, kw_only=True)
class Prbs(Excitation):
    """A maximal-length sequence."""

    clock: int = param(2, 'samples per bit', unit='samples', minimum=1)
    order: int = param(9, 'register length', choices=tuple(TAPS))

    @cached_property
    def bits(self) -> tuple[int, ...]:
        """One period, +1 and -1; `seed` chooses where it starts."""
        state = [1] * self.order
        out = []
        for _ in range(2**self.order - 1):
            out.append(1 if state[-1] else -1)
            feedback = 0
            for tap in TAPS[self.order]:
                feedback ^= state[tap - 1]
            state = [feedback, *state[:-1]]
        return tuple(out)

    def at(self, i: int) -> float:
        """Voltage in V at sample i."""
        period = len(self.bits)
        start = self.strut * period // self.struts + 37 * self.seed
        return self.amplitude * self.bits[(i // self.clock + start) % period]
