# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The controller around a law: phases, calibration, excitation, guard and vibration watch, without ROS."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.core.centralized import CentralizedCore, make_core
    from satvib_control.core.controller import ControllerCore
    from satvib_control.core.faults import Faults
    from satvib_control.core.output import ControllerOutput
    from satvib_control.core.parameters import CoreParameters
    from satvib_control.core.trusted_model import TrustedModel
    from satvib_control.core.vibration_watch import Verdict, VibrationWatch

__all__ = [
    'CentralizedCore',
    'ControllerCore',
    'ControllerOutput',
    'CoreParameters',
    'Faults',
    'TrustedModel',
    'Verdict',
    'VibrationWatch',
    'make_core',
]
__getattr__, __dir__ = door(__name__, __file__)
