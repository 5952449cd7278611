# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Control laws: what a law is, the laws by name, and the small ones; each large one has a room of its own."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.laws.base import BasicLaw, Law, LawInput, LawState
    from satvib_control.laws.off import Off
    from satvib_control.laws.parameters import LawParameters, VelocityParameters
    from satvib_control.laws.reasons import reason, text_of
    from satvib_control.laws.registry import LAWS, law_class, law_classes, make_law
    from satvib_control.laws.strut_excitation import StrutSignals
    from satvib_control.laws.sum import LawSum
    from satvib_control.laws.velocity_feedback import VelocityFeedback

__all__ = [
    'LAWS',
    'BasicLaw',
    'Law',
    'LawInput',
    'LawParameters',
    'LawState',
    'LawSum',
    'Off',
    'StrutSignals',
    'VelocityFeedback',
    'VelocityParameters',
    'law_class',
    'law_classes',
    'make_law',
    'reason',
    'text_of',
]
__getattr__, __dir__ = door(__name__, __file__)
