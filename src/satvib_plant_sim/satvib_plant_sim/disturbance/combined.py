# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Several disturbances at once: {kind: sum, terms: [{kind: sine, ...}, {kind: random, ...}]}."""

from dataclasses import dataclass
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance


@dataclass(frozen=True, kw_only=True)
class Sum(Disturbance):
    """The sum of its terms. Each term has its own times and its own target; `make_disturbance` builds the terms."""

    kind: str = param('sum', 'kind', choices=('sum',))
    terms: tuple[Any, ...] = param(description='the disturbances to add')

    def check(self) -> None:
        """Refuse times, a target or a direction of the sum itself, and terms that are not disturbances."""
        if self.start or self.stop is not None or self.target != 'base' or self.direction:
            raise SatvibError('sum: start, stop, target and direction belong to its terms')
        for i, term in enumerate(self.terms):
            if not isinstance(term, Disturbance):
                raise SatvibError(f'terms[{i}]: a disturbance is expected, not {term!r}')

    def tones(self) -> tuple[float, ...]:
        """Give all fixed frequencies, Hz, ascending."""
        return tuple(sorted({f for term in self.terms for f in term.tones()}))

    def parts(self) -> tuple[Disturbance, ...]:
        """Give the parts, those of sums within the sum too."""
        return tuple(part for term in self.terms for part in term.parts())
