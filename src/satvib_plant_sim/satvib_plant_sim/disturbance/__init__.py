# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Disturbances: one module for each kind, and the factory that makes them by name."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_plant_sim.disturbance.base import Disturbance
    from satvib_plant_sim.disturbance.combined import Sum
    from satvib_plant_sim.disturbance.factory import disturbance_kinds, make_disturbance
    from satvib_plant_sim.disturbance.mixer import Mixer
    from satvib_plant_sim.disturbance.random import Random
    from satvib_plant_sim.disturbance.reaction_wheel import MountedWheel, ReactionWheel
    from satvib_plant_sim.disturbance.shapes import Burst, Pulse, Trapezoid
    from satvib_plant_sim.disturbance.silence import Silence
    from satvib_plant_sim.disturbance.sine import Sine
    from satvib_plant_sim.disturbance.sweep import SteppedSine, Sweep
    from satvib_plant_sim.disturbance.tones import Multisine, Tones

__all__ = [
    'Burst',
    'Disturbance',
    'Mixer',
    'MountedWheel',
    'Multisine',
    'Pulse',
    'Random',
    'ReactionWheel',
    'Silence',
    'Sine',
    'SteppedSine',
    'Sum',
    'Sweep',
    'Tones',
    'Trapezoid',
    'disturbance_kinds',
    'make_disturbance',
]
__getattr__, __dir__ = door(__name__, __file__)
