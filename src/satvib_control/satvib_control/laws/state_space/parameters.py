# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the law `state_space`."""

from dataclasses import dataclass

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.schema import Fixed, param

from satvib_control.laws.parameters import VelocityParameters
from satvib_control.laws.state_space.matrices import Matrices, matrices_of


@dataclass(frozen=True, kw_only=True)
class StateSpaceParameters(VelocityParameters):
    """The matrices, row by row; `satvib_control.laws.state_space.matrices` says what they do."""

    state_space_a: tuple[float, ...] = param(
        (), 'A of law state_space, from state to state, row by row', read_only=Fixed.MEMORY
    )
    state_space_b: tuple[float, ...] = param(
        (),
        'B, from the readings (m/s^2) to the states, row by row; it says how many states there are',
        read_only=Fixed.MEMORY,
    )
    state_space_c: tuple[float, ...] = param(
        (), 'C, from the states to the voltages (V), row by row', read_only=Fixed.MEMORY
    )
    state_space_d: tuple[float, ...] = param(
        (),
        'D, from the readings to the voltages at once, row by row; empty: zero',
        unit='V/(m/s^2)',
        read_only=Fixed.MEMORY,
    )
    state_space_e: tuple[float, ...] = param(
        (),
        'E, from the applied voltages (V) to the states, row by row; empty: zero',
        read_only=Fixed.MEMORY,
    )

    @property
    def channels(self) -> int:
        """How many readings and voltages the matrices have: those of one strut."""
        return 1

    def matrices(self) -> Matrices:
        """Give the matrices.

        Raises:
            SatvibError: numbers that do not fill them.
        """
        return matrices_of(
            self.state_space_a, self.state_space_b, self.state_space_c, self.state_space_d,
            self.state_space_e, self.channels,
        )  # fmt: skip

    def check(self) -> None:
        """Check the matrices where the law is in use."""
        super().check()
        if 'state_space' not in [name.strip() for name in self.law.split('+')]:
            return
        largest = float(np.max(np.abs(np.linalg.eigvals(self.matrices().A))))
        if not largest < 1.0:
            raise SatvibError(
                f'state_space_a: its largest pole has the magnitude {largest:.6g}; below 1 is needed, because the '
                'states go on while the voltage is held at 0 V'
            )
