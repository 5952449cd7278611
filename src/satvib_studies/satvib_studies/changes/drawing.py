# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Draws what changes in a trial: the rig, its sensors and actuators, its latency, or only the disturbance.

Every trial has its own generator, `default_rng([SEED, trial])`, so a trial is the same in any batch and table.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from satvib_plant_sim.rig.rig import Rig

SEED = 13
# the time of the change is drawn here; CONTROL begins at 6.5 s
FIRST, LAST = 10.0, 13.0

RIG_KINDS = ('payload', 'stiffness', 'force', 'reversed_force', 'latency')
SENSOR_KINDS = ('reversed_sensor', 'sensor_gain', 'sensor_lost', 'sensor_clipped')
DISTURBANCE_KINDS = ('amplitude', 'shock', 'wheel', 'frequency')
KINDS = (*RIG_KINDS, *SENSOR_KINDS, *DISTURBANCE_KINDS)


@dataclass(frozen=True)
class Change:
    """What happens in a trial.

    Attributes:
        kind: one of `KINDS`.
        time: s.
        failures: as in a scenario.
        disturbance: as in a scenario, of the whole run.
        text: for tables.
    """

    kind: str
    time: float
    failures: tuple[dict[str, Any], ...]
    disturbance: dict[str, Any]
    text: str


def draw_change(rig: Rig, trial: int, kinds: tuple[str, ...] = KINDS) -> Change:
    """Draw the change of a trial.

    Args:
        rig: as it begins.
        trial: its number.
        kinds: to draw from.
    """
    rng = np.random.default_rng([SEED, trial])
    kind = kinds[int(rng.integers(len(kinds)))]
    time = float(np.round(rng.uniform(FIRST, LAST), 2))
    tone = {
        'kind': 'sine', 'frequency': float(np.round(rng.uniform(7.0, 14.0), 2)),
        'amplitude': float(np.round(rng.uniform(0.3, 0.8), 3)), 'start': 4.5,
    }  # fmt: skip
    count = rig.struts.count
    struts = [bool(rng.random() < 0.5)] * count  # all
    if not struts[0]:
        struts[int(rng.integers(count))] = True
    where = 'all' if all(struts) else f'strut {struts.index(True) + 1}'
    if kind in DISTURBANCE_KINDS:
        disturbance, failures, text = _new_disturbance(kind, time, tone, rng)
        return Change(kind, time, failures, disturbance, text)
    if kind == 'sensor_lost':
        failures = tuple(
            {'kind': 'sensor_lost', 'time': time, 'strut': i + 1}
            for i, chosen in enumerate(struts)
            if chosen
        )
        return Change(kind, time, failures, tone, f'upper sensor lost, {where}')
    changes, text = _new_rig(kind, rig, struts, where, rng)
    return Change(
        kind, time, ({'kind': 'rig_changed', 'time': time, 'changes': changes},), tone, text
    )


def _ratio(rng: np.random.Generator, low: float, high: float) -> float:
    """A factor, even in its logarithm."""
    return float(np.round(np.exp(rng.uniform(np.log(low), np.log(high))), 3))


def _new_rig(
    kind: str, rig: Rig, struts: list[bool], where: str, rng: np.random.Generator
) -> tuple[dict[str, Any], str]:
    """New values by dotted key, and what they are in words."""

    def each(value: float) -> list[float]:
        return [value if chosen else 1.0 for chosen in struts]

    sensors = [1.0] * rig.struts.count  # the lower ones stay
    if kind == 'payload':
        factor = _ratio(rng, 0.7, 1.43)
        return {'payload.mass': rig.payload.mass * factor}, f'payload x{factor}'
    if kind == 'stiffness':
        factor = _ratio(rng, 0.5, 1.6)
        return {'struts.stiffness_scale': each(factor)}, f'stiffness x{factor}, {where}'
    if kind == 'force':
        factor = _ratio(rng, 0.3, 3.0)
        return {'coil.force_scale': each(factor)}, f'force x{factor}, {where}'
    if kind == 'reversed_force':
        return {'coil.force_scale': each(-1.0)}, f'force reversed, {where}'
    if kind == 'latency':
        late = int(rng.integers(1, 4))
        periods = [late if chosen else 0 for chosen in struts]
        return {'acquisition.periods_late': periods}, f'{late} samples later, {where}'
    if kind == 'reversed_sensor':
        return {'accelerometer.scale': [*each(-1.0), *sensors]}, f'sensor reversed, {where}'
    if kind == 'sensor_gain':
        factor = _ratio(rng, 0.3, 3.0)
        return {'accelerometer.scale': [*each(factor), *sensors]}, f'sensor x{factor}, {where}'
    top = float(np.round(rng.uniform(0.1, 2.0), 2))
    return {'accelerometer.range': top}, f'sensors clip at {top} m/s^2'


def _new_disturbance(
    kind: str, time: float, tone: dict[str, Any], rng: np.random.Generator
) -> tuple[dict[str, Any], tuple[dict[str, Any], ...], str]:
    """The disturbance of the whole run, what happens in it, and that in words."""
    if kind == 'amplitude':
        factor = _ratio(rng, 0.2, 4.0)
        other = tone | {'amplitude': tone['amplitude'] * factor}
        return tone, (_changed(time, other),), f'amplitude x{factor}'
    if kind == 'frequency':
        hertz = float(np.round(rng.uniform(7.0, 14.0), 2))
        return tone, (_changed(time, tone | {'frequency': hertz}),), f'tone to {hertz} Hz'
    if kind == 'shock':
        peak = float(np.round(rng.uniform(2.0, 20.0), 1))
        shock = {'kind': 'pulse', 'start': time, 'amplitude': peak, 'duration': 0.02}
        return {'kind': 'sum', 'terms': [tone, shock]}, (), f'shock of {peak} m/s^2'
    slow, fast = sorted(float(np.round(rng.uniform(5.0, 16.0), 2)) for _ in range(2))
    first, last = (slow, fast) if rng.random() < 0.5 else (fast, slow)
    duration = float(np.round(rng.uniform(3.0, 10.0), 1))
    unbalance = tone['amplitude'] / (2.0 * np.pi * 10.0) ** 2  # the tone's amplitude at 10 Hz
    wheel = {
        'kind': 'reaction_wheel', 'start': 4.5, 'speed': first, 'end_speed': last,
        'ramp_start': time - 4.5, 'ramp_time': duration, 'coefficients': [unbalance],
    }  # fmt: skip
    return wheel, (), f'wheel from {first} to {last} Hz in {duration} s'


def _changed(time: float, disturbance: dict[str, Any]) -> dict[str, Any]:
    return {'kind': 'disturbance_changed', 'time': time, 'disturbance': disturbance}
