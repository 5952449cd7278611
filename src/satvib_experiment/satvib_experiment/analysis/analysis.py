# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Everything that is said about one run: its figures, its notes, its open-loop twin."""

from satvib_experiment.analysis.evaluation import Evaluation, evaluate
from satvib_experiment.analysis.notes import notes_for
from satvib_experiment.recording.recording import Recording
from satvib_experiment.twin.closed_loop import simulate_open_loop


def analyse(recording: Recording) -> tuple[Evaluation, Recording | None]:
    """Evaluate a run; a simulated one beside its open-loop twin on the same seed, which is given too.

    Raises:
        SatvibError: the recording ends before its own windows.
    """
    simulated = recording.scenario is not None and recording.has('truth')
    open_loop = simulate_open_loop(recording) if simulated else None
    evaluation = evaluate(recording, open_loop)
    evaluation.notes = notes_for(recording, evaluation)
    return evaluation, open_loop
