# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Signals sample by sample: recursive filters, drift-free integration, bias at rest, running RMS."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.signals.calibration import BiasCalibration
    from satvib_common.signals.crest import low_crest_phases
    from satvib_common.signals.iir_filter import IirFilter
    from satvib_common.signals.integrator import LeakyIntegrator
    from satvib_common.signals.readings import possible
    from satvib_common.signals.statistics import MovingRms

__all__ = [
    'BiasCalibration',
    'IirFilter',
    'LeakyIntegrator',
    'MovingRms',
    'low_crest_phases',
    'possible',
]
__getattr__, __dir__ = door(__name__, __file__)
