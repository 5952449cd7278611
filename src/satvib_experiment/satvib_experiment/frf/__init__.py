# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Frequency responses of a rig or a run: how they are measured, estimated, compared with the exact ones, and shown."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.frf.curve import Curve
    from satvib_experiment.frf.measure import (
        Measured,
        measure_columns,
        measure_recording,
        measure_scenario,
    )
    from satvib_experiment.frf.measurement import (
        MeasurementSettings,
        base_scenario,
        coil_scenario,
    )
    from satvib_experiment.frf.merit import Merit, merit_of
    from satvib_experiment.frf.paths import coupling, secondary_paths
    from satvib_experiment.frf.transmission import transmissibilities

__all__ = [
    'Curve',
    'Measured',
    'MeasurementSettings',
    'Merit',
    'base_scenario',
    'coil_scenario',
    'coupling',
    'measure_columns',
    'measure_recording',
    'measure_scenario',
    'merit_of',
    'secondary_paths',
    'transmissibilities',
]
__getattr__, __dir__ = door(__name__, __file__)
