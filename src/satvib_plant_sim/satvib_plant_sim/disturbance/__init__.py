# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Disturbances by kind: make_disturbance({'kind': 'sine', 'start': 5.0, 'amplitude': 1.0, 'frequency': 10.0})."""

from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.factory import disturbance_kinds, make_disturbance

__all__ = ['Disturbance', 'disturbance_kinds', 'make_disturbance']
