# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The best periodic command: least squares over all voltages of a period, on the simulated plant, without a formula.

No law knows it in advance. It says how much of the true vibration any held voltage can take away, and with that it is
the truth that laws and formulas are judged by.
"""

import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import decibel, rms

from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.rig import Rig

SETTLE = 400  # samples, at least, until the plant repeats itself


def periodic_response(rig: Rig, disturbance: Disturbance, voltages: Array) -> Array:
    """Give the true upper accelerations over one period of the voltages, in the steady state.

    Args:
        rig: whose plant is simulated from rest.
        disturbance: whose period divides that of the voltages.
        voltages: (period,), V, the same at all struts.

    Returns:
        (fine samples, struts), m/s^2.
    """
    plant, period = Plant(rig, disturbance, 1), len(voltages)
    settled = -(-SETTLE // period) * period
    found = []
    for k in range(settled + period):
        truth = plant.advance(np.full(plant.struts, voltages[k % period]))
        if k >= settled:
            found.append(truth.upper.T)
    return np.concatenate(found)


def best_command(rig: Rig, frequency: float, period: int) -> Array:
    """Give the least true RMS that voltages of that period leave, (struts,), dB of what is there at 0 V.

    Args:
        rig: whose struts all get the same voltage; each strut is judged with the voltage that is best for it.
        frequency: Hz, of a vibration of the base.
        period: samples after which the voltage repeats; a whole number of periods of the vibration.
    """
    tone = make_disturbance({'kind': 'sine', 'frequency': frequency, 'amplitude': 1.0})
    idle = periodic_response(rig, tone, np.zeros(period))
    pulse = periodic_response(rig, make_disturbance(None), np.eye(period)[0])
    steps = len(pulse) // period
    left = np.empty_like(idle)
    for i in range(idle.shape[1]):
        effects = np.stack([np.roll(pulse[:, i], steps * k) for k in range(period)], axis=1)
        command = np.linalg.lstsq(effects, -idle[:, i], rcond=None)[0]
        left[:, i] = idle[:, i] + effects @ command
    return np.asarray(decibel(rms(left), rms(idle)))
