# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""From a recording to figures: windows, levels, attenuations, and what must be said about them."""

from satvib_experiment.analysis.evaluation import Evaluation, evaluate
from satvib_experiment.analysis.notes import notes_for
from satvib_experiment.recording.recording import Recording

__all__ = ['Evaluation', 'analyse', 'evaluate']


def analyse(recording: Recording) -> tuple[Evaluation, Recording | None]:
    """Evaluate a run; a simulated one beside its open-loop twin on the same seed, which is given too.

    Raises:
        SatvibError: the recording ends before its own windows.
    """
    open_loop = None
    if recording.scenario is not None and recording.has('truth'):
        from satvib_experiment.twin.closed_loop import simulate_open_loop

        open_loop = simulate_open_loop(recording)
    evaluation = evaluate(recording, open_loop)
    evaluation.notes = notes_for(recording, evaluation)
    return evaluation, open_loop
