# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Exact transmissibility of a rig, payload over base at every strut, open loop or with a linear law.

With d the acceleration of the source, u the sampled voltages and y the readings of the upper sensors

    upper = T_d d + T_u u,   lower = L_d d + L_u u,   y = R_d d + G u,   u = -C y

so u = -C (1 + G C)^-1 R_d d, and the transmissibility of strut i is upper_i / lower_i. G is exact: it holds what the
samples fold from above half the sample rate. T_u and L_u are those of the baseband. Noise, quantization, stops and
limits are left out.
"""

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Complex

from satvib_plant_sim.disturbance.base import UPWARD
from satvib_plant_sim.responses.all_struts import sampled_rig
from satvib_plant_sim.responses.continuous import frequency_response, state_space
from satvib_plant_sim.responses.images import hold_response
from satvib_plant_sim.rig.rig import Rig


def plate_responses(
    rig: Rig,
    frequency: ArrayLike,
    feedback: Complex | None = None,
    source: str = 'base',
    direction: tuple[float, ...] = UPWARD,
) -> tuple[Complex, Complex]:
    """Give the accelerations of both plates at the struts, per unit of a source.

    Args:
        rig: the rig.
        frequency: (f,) Hz, none of them 0.
        feedback: (f, n, n) C in V per m/s^2, from readings to voltages, u = -C y; None: 0 V.
        source: 'base' (m/s^2) or 'payload' (N).
        direction: of listed struts: factors of the source along and about x, y, z. Struts on a circle have z alone.

    Returns:
        Upper and lower plate, (f, n) each.
    """
    f = np.asarray(frequency, dtype=float)
    n = rig.struts.count
    space = state_space(rig)
    outputs, inputs = list(space.outputs), list(space.inputs)
    both = frequency_response(rig, f)
    struts = [str(i + 1) for i in range(n)]
    upper = [outputs.index(f'upper_{i}') for i in struts]
    lower = [outputs.index(f'lower_{i}' if f'lower_{i}' in outputs else 'lower') for i in struts]
    read = [outputs.index(f'read_upper_{i}') for i in struts]
    volts = [inputs.index(f'voltage_{i}') for i in struts]
    if source in inputs:
        d = both[:, :, inputs.index(source)]
    else:
        first = inputs.index(f'{source}_x')
        d = both[:, :, first : first + len(UPWARD)] @ np.array(direction)
    if feedback is None:
        return d[:, upper], d[:, lower]
    hold = hold_response(rig.acquisition, f)[:, None, None]
    loop = np.eye(n) + sampled_rig(rig).response(f) @ feedback
    u = -feedback @ np.linalg.solve(loop, d[:, read][..., None])
    moved = both[:, :, volts] * hold @ u
    return d[:, upper] + moved[:, upper, 0], d[:, lower] + moved[:, lower, 0]


def transmissibility(
    rig: Rig,
    frequency: ArrayLike,
    feedback: Complex | None = None,
    direction: tuple[float, ...] = UPWARD,
) -> Complex:
    """Give upper over lower acceleration of each strut (f, n) for a moving base; arguments as above."""
    upper, lower = plate_responses(rig, frequency, feedback, direction=direction)
    return np.asarray(upper / lower)
