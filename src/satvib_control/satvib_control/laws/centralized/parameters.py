# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the centralized controller; also the ROS parameters of `centralized_controller`."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.schema import Fixed, param

from satvib_control.parameters import ControllerParameters


@dataclass(frozen=True, kw_only=True)
class CentralizedParameters(ControllerParameters):
    """The parameters of a strut's controller, with the geometry and the gains of the modal law.

    The gains are in the order w, alpha, beta. A tilt is the motion that it makes at the circle of the struts, so all
    three have one unit, and equal gains are the same gain at every strut.
    """

    law: str = param(
        'centralized',
        'law; no other law gets the samples of all struts',
        choices=('centralized',),
        read_only=Fixed.MEMORY,
    )
    strut_angles: tuple[float, ...] = param(
        (90.0, 210.0, 330.0), 'angles of the struts, from x', unit='deg', read_only=Fixed.RIG
    )
    gains_p: tuple[float, ...] = param(
        (0.0, 0.0, 0.0),
        'P, on the velocity of each mode: acts like a damper',
        unit='V/(m/s)',
    )
    gains_i: tuple[float, ...] = param(
        (0.0, 0.0, 0.0),
        'I, on the position of each mode: acts like a spring',
        unit='V/m',
    )
    gains_d: tuple[float, ...] = param(
        (0.0, 0.0, 0.0),
        'D, on the acceleration of each mode: acts like a mass',
        unit='V/(m/s^2)',
    )

    def check(self) -> None:
        """Refuse gains that are not one per mode."""
        super().check()
        if self.struts not in {1, 3}:
            raise SatvibError(f'struts: {self.struts} struts have no modes w, alpha, beta')
        for name in ('strut_angles', 'gains_p', 'gains_i', 'gains_d'):
            given = len(getattr(self, name))
            if given < self.struts:
                raise SatvibError(f'{name}: {given} values for {self.struts} struts')
