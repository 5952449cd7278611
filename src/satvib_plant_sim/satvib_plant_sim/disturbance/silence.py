# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""No disturbance."""

from dataclasses import dataclass

from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance


@dataclass(frozen=True, kw_only=True)
class Silence(Disturbance):
    """No disturbance."""

    kind: str = param('none', 'kind', choices=('none',))

    def parts(self) -> tuple[Disturbance, ...]:
        """Nothing to add."""
        return ()
