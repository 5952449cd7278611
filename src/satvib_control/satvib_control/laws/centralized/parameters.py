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
    three have one unit, and equal gains are the same gain at every strut. With `strut_shapes` the order is that of its
    columns: x, y, z, rx, ry, rz for a payload that moves freely.
    """

    law: str = param(
        'centralized',
        'law; no other law gets the samples of all struts',
        choices=('centralized', 'state_space'),
        read_only=Fixed.MEMORY,
    )
    strut_angles: tuple[float, ...] = param(
        (90.0, 210.0, 330.0), 'angles of the struts, from x', unit='deg', read_only=Fixed.RIG
    )
    strut_shapes: tuple[float, ...] = param(
        (),
        'listed struts: what each motion of the payload does along each strut, strut by strut; a turn as the motion '
        'that it makes at the mean distance of the struts',
        read_only=Fixed.RIG,
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

    @property
    def channels(self) -> int:
        """How many readings and voltages the matrices of law state_space have: those of all struts."""
        return self.struts

    def check(self) -> None:
        """Refuse gains that are not one per mode."""
        super().check()
        if self.strut_shapes:
            if len(self.strut_shapes) % self.struts:
                raise SatvibError(
                    f'strut_shapes: {len(self.strut_shapes)} numbers are no rows for {self.struts} struts'
                )
            of = f'{self.modes} motions'
        elif self.struts not in {1, 3}:
            raise SatvibError(f'struts: {self.struts} struts have no modes w, alpha, beta')
        else:
            of = f'{self.struts} struts'
            given = len(self.strut_angles)
            if given < self.struts:
                raise SatvibError(f'strut_angles: {given} values for {of}')
        for name in ('gains_p', 'gains_i', 'gains_d'):
            gains = getattr(self, name)
            # gains that are all 0 may be left out
            if len(gains) < self.modes and (any(gains) or not self.strut_shapes):
                raise SatvibError(f'{name}: {len(gains)} values for {of}')

    @property
    def modes(self) -> int:
        """Motions of the payload."""
        return len(self.strut_shapes) // self.struts if self.strut_shapes else self.struts

    def gains(self) -> tuple[tuple[float, ...], ...]:
        """Give the rows P, I, D, one gain for each motion."""
        rows = (self.gains_p, self.gains_i, self.gains_d)
        return tuple((*row, *(0.0,) * self.modes)[: self.modes] for row in rows)
