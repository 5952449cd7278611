# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The sizes of a rig, and the state of mechanics and coils: which number of a vector is what.

The same views serve numbers, matrices and indices: `state_of(np.arange(state_size(size)), size).current` are the
indices of the currents. Compiled code calls `compiled_state_of`.
"""

from typing import Any, NamedTuple

from satvib_common.kernels.deferred import njit

from satvib_plant_sim.rig.rig import Rig


class Size(NamedTuple):
    """How many of each a rig has.

    Attributes:
        struts: n.
        plate: directions in which the lower plate moves, 1 (along z) or 6.
        payload: disturbance forces and moments on the payload, 1 (along z) or 6.
    """

    struts: int
    plate: int
    payload: int


class State(NamedTuple):
    """Views of the first 3n + 2b numbers of a vector, for n struts and b directions of the lower plate.

    Attributes:
        stroke: (n) s, m.
        rate: (n) s', m/s.
        current: (n) i, A.
        plate: (b) z, m and rad, relative to the shaker's source.
        plate_rate: (b) z', m/s and rad/s.
    """

    stroke: Any
    rate: Any
    current: Any
    plate: Any
    plate_rate: Any


def size_of(rig: Rig) -> Size:
    """Give the sizes of a rig."""
    directions = 6 if rig.struts.each else 1
    return Size(struts=rig.struts.count, plate=directions, payload=directions)


def state_size(size: Size) -> int:
    """Give the length of the state."""
    return 3 * size.struts + 2 * size.plate


def lower_readings(size: Size) -> int:
    """Give how many different accelerations the lower sensors have: under struts on a circle they are all one."""
    return 1 if size.plate == 1 else size.struts


def state_views(x: Any, n: int, b: int) -> State:
    """Give the views of a vector x (at least 3n + 2b)."""
    return State(
        stroke=x[:n],
        rate=x[n : 2 * n],
        current=x[2 * n : 3 * n],
        plate=x[3 * n : 3 * n + b],
        plate_rate=x[3 * n + b : 3 * n + 2 * b],
    )


def state_of(x: Any, size: Size) -> State:
    """Give the views of a vector x (at least `state_size`)."""
    return state_views(x, size.struts, size.plate)


compiled_state_of = njit(state_views)
