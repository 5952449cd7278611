# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The controller around a law: phases, calibration, excitation, guard and divergence watch, without ROS."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.core.centralized import CentralizedCore, make_core
    from satvib_control.core.controller import ControllerCore
    from satvib_control.core.divergence_watch import DivergenceWatch, WatchState, WatchVerdict
    from satvib_control.core.faults import Faults
    from satvib_control.core.output import ControllerOutput
    from satvib_control.core.parameters import CoreParameters
    from satvib_control.core.trusted_model import TrustedModel

__all__ = [
    'CentralizedCore',
    'ControllerCore',
    'ControllerOutput',
    'CoreParameters',
    'DivergenceWatch',
    'Faults',
    'TrustedModel',
    'WatchState',
    'WatchVerdict',
    'make_core',
]
__getattr__, __dir__ = door(__name__, __file__)
