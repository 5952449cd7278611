# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What every excitation signal has: a peak in V, a sample period and a strut, and its value at a sample index."""

from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_common.schema import Schema, param


@dataclass(frozen=True, kw_only=True)
class Excitation(Schema):
    """A voltage as a function of the sample index since the phase began, |u| <= amplitude.

    The struts of one isolator get different signals of one kind, so that the motion that one causes is not taken for
    the response of another.
    """

    amplitude: float = param(description='largest voltage', unit='V', minimum=0.0)
    dt: float = param(description='sample period', unit='s', above=0.0)
    strut: int = param(0, 'which strut, from 0', minimum=0)
    struts: int = param(3, 'how many struts share the isolator', minimum=1)
    seed: int = param(0, 'seed of what is random', minimum=0)
    turn: float = param(
        0.0,
        'struts take turns, one at a time and each for so long; 0: all at once',
        unit='s',
        minimum=0.0,
    )

    def at(self, i: int) -> float:
        """Voltage in V at sample i >= 0 of the phase."""
        raise NotImplementedError

    def in_turn(self, i: int) -> float:
        """Voltage in V at sample i, 0 in the turns of the other struts; each turn begins the signal again."""
        length = round(self.turn / self.dt)
        if not length:
            return self.at(i)
        turn, since = divmod(i, length)
        return self.at(since) if turn % self.struts == self.strut else 0.0

    def samples(self, count: int) -> Array:
        """The first `count` samples, V."""
        return np.array([self.in_turn(i) for i in range(count)], dtype=float)
