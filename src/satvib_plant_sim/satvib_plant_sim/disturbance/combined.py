# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Several disturbances at once: {kind: sum, terms: [{kind: sine, ...}, {kind: random, ...}]}."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

from satvib_common.errors import SatvibError
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance


@dataclass(frozen=True, kw_only=True)
class Sum(Disturbance):
    """The sum of its terms; when and where is said at each term."""

    kind: str = param('sum', 'kind', choices=('sum',))
    terms: tuple[Any, ...] = param(description='the disturbances to add')

    def check(self) -> None:
        """Refuse a time or a target of the whole, and terms that are none."""
        if self.start or self.stop is not None or self.target != 'base':
            raise SatvibError('sum: start, stop and target belong to its terms')
        for i, term in enumerate(self.terms):
            if not isinstance(term, Disturbance):
                raise SatvibError(f'terms[{i}]: a disturbance is expected, not {term!r}')

    @classmethod
    def from_mapping(cls, mapping: Any, where: str = '') -> Self:
        """Build the terms first, so that the message names the one that is wrong."""
        from satvib_plant_sim.disturbance.factory import make_disturbance

        if isinstance(mapping, Mapping) and isinstance(mapping.get('terms'), list | tuple):
            terms = mapping['terms']
            mapping = {
                **mapping,
                'terms': tuple(
                    make_disturbance(term, f'{where}: terms[{i}]') for i, term in enumerate(terms)
                ),
            }
        return super().from_mapping(mapping, where)

    def tones(self) -> tuple[float, ...]:
        """Give all fixed frequencies, Hz, ascending."""
        return tuple(sorted({f for term in self.terms for f in term.tones()}))

    def parts(self) -> tuple[Disturbance, ...]:
        """Give the parts, sums within sums opened."""
        return tuple(part for term in self.terms for part in term.parts())
