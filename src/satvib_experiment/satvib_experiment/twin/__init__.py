# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The offline twin: the closed loop of a scenario in one process, with the bits of the live graph."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.twin.closed_loop import (
        ClosedLoop,
        simulate,
        simulate_batch,
        simulate_open_loop,
    )
    from satvib_experiment.twin.noise_free import perfect_parameters
    from satvib_experiment.twin.step import LoopStep
    from satvib_experiment.twin.step_recorder import StepRecorder

__all__ = [
    'ClosedLoop',
    'LoopStep',
    'StepRecorder',
    'perfect_parameters',
    'simulate',
    'simulate_batch',
    'simulate_open_loop',
]
__getattr__, __dir__ = door(__name__, __file__)
