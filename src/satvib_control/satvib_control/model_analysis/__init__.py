# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an identified model says about a loop: gain bounds, margins, the dominant mode."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.model_analysis.dominant_mode import damping_gain, dominant_pole, polarity
    from satvib_control.model_analysis.gain_bounds import GainBounds
    from satvib_control.model_analysis.gain_projection import loop_grid, ray
    from satvib_control.model_analysis.margins import Margins, loop_response
    from satvib_control.model_analysis.transfer import (
        broadcast_model,
        model_polynomials,
        multiply,
        respond,
        stable,
        value,
    )

__all__ = [
    'GainBounds',
    'Margins',
    'broadcast_model',
    'damping_gain',
    'dominant_pole',
    'loop_grid',
    'loop_response',
    'model_polynomials',
    'multiply',
    'polarity',
    'ray',
    'respond',
    'stable',
    'value',
]
__getattr__, __dir__ = door(__name__, __file__)
