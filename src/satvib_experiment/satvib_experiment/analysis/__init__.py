# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""From a recording to figures: windows, levels, attenuations, and the notes on them."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.analysis.analysis import analyse
    from satvib_experiment.analysis.evaluation import Evaluation, evaluate
    from satvib_experiment.analysis.levels import moving_rms, spectrum, tone_amplitudes, tone_level
    from satvib_experiment.analysis.notes import notes_for
    from satvib_experiment.analysis.windows import Windows, find_windows

__all__ = [
    'Evaluation',
    'Windows',
    'analyse',
    'evaluate',
    'find_windows',
    'moving_rms',
    'notes_for',
    'spectrum',
    'tone_amplitudes',
    'tone_level',
]
__getattr__, __dir__ = door(__name__, __file__)
