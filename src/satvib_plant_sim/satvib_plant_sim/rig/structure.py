# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The mechanical parts of a rig: payload, struts and what the lower plate stands on, each a checked description.

The struts stand evenly on a circle and push along z, or the rig lists them (`struts.each`), each with its own line of
action. All places are in one frame; its origin is where the rotations of the lower plate are counted from.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param
from satvib_common.struts.names import strut_angles

# m; beyond these a number is most often one in mm. Nothing stands further from the origin, as CAD may place it
FARTHEST = 50.0
_LONGEST, _SHORTEST = 10.0, 1e-4  # of a strut from foot to head, and of a radius
_LONGEST_STROKE = 1.0
# translations, then rotations about the same axes
MOTIONS = ('x', 'y', 'z', 'rx', 'ry', 'rz')


def _three(name: str, values: Sequence[float]) -> None:
    if len(values) != 3:
        raise SatvibError(f'{name}: {len(values)} numbers, x, y and z are expected')


@dataclass(frozen=True, kw_only=True)
class Payload(Schema):
    """The rigid upper plate with what sits on it; w, alpha and beta are its motions (the paper's Fig. 1).

    Struts on a circle have `inertia`. Listed struts have `inertia_tensor`, `center_of_gravity` and `motions`.
    """

    mass: float = param(description='mass, coils included', unit='kg', above=0.0)
    inertia: float | None = param(
        None, 'moment of inertia about x and about y; none: 0.55 m r^2', unit='kg m^2', above=0.0
    )
    force_x: float = param(
        0.0, 'where a disturbance force acts, x from the centre of gravity',
        unit='m', minimum=-FARTHEST, maximum=FARTHEST,
    )  # fmt: skip
    force_y: float = param(
        0.0, 'where a disturbance force acts, y from the centre of gravity',
        unit='m', minimum=-FARTHEST, maximum=FARTHEST,
    )  # fmt: skip
    inertia_tensor: tuple[float, ...] | None = param(
        None,
        'Ixx, Iyy, Izz, or those and Ixy, Ixz, Iyz (elements of the matrix), about the centre of gravity',
        unit='kg m^2',
    )
    center_of_gravity: tuple[float, ...] = param(
        (0.0, 0.0, 0.0), 'x, y, z in the frame of the struts',
        unit='m', minimum=-FARTHEST, maximum=FARTHEST,
    )  # fmt: skip
    motions: tuple[str, ...] = param(
        MOTIONS, 'in which the payload can move; guides hold the others', choices=MOTIONS
    )

    def check(self) -> None:
        """Refuse a tensor that no body has, and motions that are named twice."""
        _three('center_of_gravity', self.center_of_gravity)
        if not self.motions or len(set(self.motions)) != len(self.motions):
            raise SatvibError('motions: each is named once, and at least one')
        t = self.inertia_tensor
        if t is None:
            return
        if len(t) not in {3, 6}:
            raise SatvibError(f'inertia_tensor: {len(t)} numbers, not 3 or 6')
        xx, yy, zz, xy, xz, yz = (*t, 0.0, 0.0, 0.0)[:6]
        minor = xx * yy - xy * xy
        det = zz * minor - yz * (xx * yz - xy * xz) + xz * (xy * yz - yy * xz)
        if not (xx > 0.0 and minor > 0.0 and det > 0.0):
            raise SatvibError('inertia_tensor: not positive definite, no body has it')


@dataclass(frozen=True, kw_only=True)
class Strut(Schema):
    """One listed strut: its line of action, and what it is made of where that is its own."""

    foot: tuple[float, ...] = param(
        description='on the lower plate: x, y, z', unit='m', minimum=-FARTHEST, maximum=FARTHEST
    )
    head: tuple[float, ...] | None = param(
        None, 'on the payload: x, y, z', unit='m', minimum=-FARTHEST, maximum=FARTHEST
    )
    direction: tuple[float, ...] | None = param(
        None, 'from foot to head, of any length; in place of head'
    )
    stiffness: float | None = param(None, 'none: that of all struts', unit='N/m', above=0.0)
    damping: float | None = param(None, 'none: that of all struts', unit='N s/m', minimum=0.0)
    stroke_limit: float | None = param(
        None, 'none: that of all struts', unit='m', above=0.0, maximum=_LONGEST_STROKE
    )
    force_constant: float | None = param(None, 'none: that of the coil', unit='N/A', minimum=0.0)
    force_limit: float | None = param(None, 'none: that of the coil', unit='N', above=0.0)
    resistance: float | None = param(None, 'none: that of the coil', unit='ohm', above=0.0)
    inductance: float | None = param(None, 'none: that of the coil', unit='H', above=0.0)

    def check(self) -> None:
        """Refuse a strut without a line of action."""
        if (self.head is None) == (self.direction is None):
            raise SatvibError('head: a strut has either head or direction')
        for name in ('foot', 'head', 'direction'):
            if getattr(self, name) is not None:
                _three(name, getattr(self, name))
        if not math.hypot(*self.along) > 1e-9:
            raise SatvibError(f'{"direction" if self.head is None else "head"}: gives no direction')
        length = math.hypot(*self.along)
        if self.head is not None and not _SHORTEST <= length <= _LONGEST:
            raise SatvibError(
                f'head: {length:.4g} m from foot; a strut is {_SHORTEST:g} to {_LONGEST:g} m long'
            )

    @property
    def along(self) -> tuple[float, ...]:
        """From foot to head, of any length."""
        if self.head is None:
            return self.direction or (0.0, 0.0, 0.0)
        return tuple(h - f for h, f in zip(self.head, self.foot, strict=True))


@dataclass(frozen=True, kw_only=True)
class Struts(Schema):
    """Spring and damper of each strut (K_i and C_i of the paper's Fig. 2), and where the struts stand."""

    count: int = param(
        0,
        'struts on a circle: 3 move w, alpha, beta; 1 moves w. Listed struts are counted',
        minimum=0,
    )
    radius: float = param(
        0.15, 'distance of a strut from the axis', unit='m', minimum=_SHORTEST, maximum=_LONGEST
    )
    first_angle: float = param(90.0, 'angle of strut 1 from x; the others evenly on', unit='deg')
    each: tuple[Strut, ...] = param((), 'listed struts; none: they stand on a circle')
    stiffness: float = param(description='stiffness of one strut', unit='N/m', above=0.0)
    stiffness_scale: tuple[float, ...] = param(
        (1.0, 1.0, 1.0), 'factor on the stiffness, strut by strut', above=0.0
    )
    damping: float = param(description='mechanical damping of one strut', unit='N s/m', minimum=0.0)
    damping_scale: tuple[float, ...] = param(
        (1.0, 1.0, 1.0), 'factor on the damping, strut by strut', minimum=0.0
    )
    stroke_limit: float = param(
        description='stroke to the stop, either way',
        unit='m',
        above=0.0,
        maximum=_LONGEST_STROKE,
    )
    stop_stiffness: float = param(description='stiffness of a stop', unit='N/m', above=0.0)
    stop_damping: float = param(description='damping of a stop', unit='N s/m', minimum=0.0)

    @property
    def angles(self) -> list[float]:
        """Angles of the struts on a circle from x, deg."""
        return strut_angles(self.count, self.first_angle)

    def own(self, name: str, common: float) -> list[float]:
        """Give a quantity of every strut: its own where it is listed with one, else the common one."""
        if not self.each:
            return [common] * self.count
        values = [getattr(strut, name) for strut in self.each]
        return [common if value is None else value for value in values]

    def check(self) -> None:
        """Count listed struts, and refuse factors that do not fit the struts."""
        if not self.each and self.count not in {1, 3}:
            raise SatvibError(
                f'count: {self.count} is not one of 1, 3; any other number of struts is listed, in each'
            )
        if self.each:
            if self.count not in {0, len(self.each)}:
                raise SatvibError(f'count: {self.count}, but {len(self.each)} struts are listed')
            object.__setattr__(self, 'count', len(self.each))
        for name in ('stiffness_scale', 'damping_scale'):
            object.__setattr__(self, name, factors(getattr(self, name), self, name))


def factors(given: tuple[float, ...], struts: Struts, name: str) -> tuple[float, ...]:
    """Give the factors of all struts; listed ones may leave them out.

    Raises:
        SatvibError: fewer factors than struts.
    """
    if struts.each and given == (1.0, 1.0, 1.0):
        return (1.0,) * struts.count
    if len(given) < struts.count:
        raise SatvibError(f'{name}: {len(given)} factors for {struts.count} struts')
    return given


@dataclass(frozen=True, kw_only=True)
class Shaker(Schema):
    """What the lower plate stands on. It moves along z under struts on a circle, else in six directions."""

    rigid: bool = param(False, 'the lower plate follows the source, without reaction of the struts')
    mass: float | None = param(
        None, 'armature and lower plate; a rigid shaker may leave it out', unit='kg', above=0.0
    )
    inertia: float | None = param(
        None,
        'listed struts: moment of inertia of the lower plate about each axis; none: that of its mass at the mean '
        'distance of the feet',
        unit='kg m^2',
        above=0.0,
    )  # fmt: skip
    stiffness: float | None = param(
        None, 'from the source to the plate; likewise', unit='N/m', above=0.0
    )
    damping: float | None = param(
        None, 'from the source to the plate; likewise', unit='N s/m', minimum=0.0
    )

    def check(self) -> None:
        """Refuse a plate that gives way, and whose suspension is not known."""
        missing = [name for name in Suspension._fields if getattr(self, name) is None]
        if missing and not self.rigid:
            raise SatvibError(f'{", ".join(missing)}: missing; only a rigid shaker needs none')

    @property
    def suspension(self) -> 'Suspension':
        """What holds the lower plate; for a rigid shaker it has no meaning, and may be any."""
        return Suspension(
            1.0 if self.mass is None else self.mass,
            self.stiffness or 0.0,
            self.damping or 0.0,
        )


class Suspension(NamedTuple):
    """Mass of the lower plate, kg, and its suspension, N/m and N s/m."""

    mass: float
    stiffness: float
    damping: float
