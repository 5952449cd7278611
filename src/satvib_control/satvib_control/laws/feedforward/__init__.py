# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The law `feedforward`: the vibration of the lower plate is cancelled before it reaches the payload."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.laws.feedforward.backoff import Backoff, BackoffState
    from satvib_control.laws.feedforward.law import Feedforward
    from satvib_control.laws.feedforward.parameters import FeedforwardParameters
    from satvib_control.laws.feedforward.wiener import (
        CoherenceBound,
        WienerOptimum,
        coherence_bound,
        uncontrolled,
        wiener_from_spectra,
        wiener_optimum,
    )

__all__ = [
    'Backoff',
    'BackoffState',
    'CoherenceBound',
    'Feedforward',
    'FeedforwardParameters',
    'WienerOptimum',
    'coherence_bound',
    'uncontrolled',
    'wiener_from_spectra',
    'wiener_optimum',
]
__getattr__, __dir__ = door(__name__, __file__)
