# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Control laws for active vibration isolation, and the controller around them; a strut alone, or all struts at once."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.core.centralized import CentralizedCore, make_core
    from satvib_control.core.controller import ControllerCore
    from satvib_control.core.output import ControllerOutput
    from satvib_control.laws.base import BasicLaw, Law, LawInput, LawState
    from satvib_control.laws.centralized.parameters import CentralizedParameters
    from satvib_control.laws.parameters import LawParameters
    from satvib_control.laws.reasons import reason, text_of
    from satvib_control.laws.registry import LAWS, law_class, make_law
    from satvib_control.model_analysis.gain_bounds import GainBounds, gain_bounds
    from satvib_control.model_analysis.margins import Margins, margins
    from satvib_control.parameters import ControllerParameters

__all__ = [
    'LAWS',
    'BasicLaw',
    'CentralizedCore',
    'CentralizedParameters',
    'ControllerCore',
    'ControllerOutput',
    'ControllerParameters',
    'GainBounds',
    'Law',
    'LawInput',
    'LawParameters',
    'LawState',
    'Margins',
    'gain_bounds',
    'law_class',
    'make_core',
    'make_law',
    'margins',
    'reason',
    'text_of',
]
__getattr__, __dir__ = door(__name__, __file__)
