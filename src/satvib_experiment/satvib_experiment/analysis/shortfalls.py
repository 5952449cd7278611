# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a run did what it was made for: a run under control that controlled nothing must not look like a success."""

import numpy as np
from satvib_common.arrays import Mask
from satvib_common.phases import Phase
from satvib_common.struts.applied import TEXTS, Applied

from satvib_experiment.analysis.evaluation import Evaluation
from satvib_experiment.recording.recording import Recording

# share of all answers, and of all samples, that may be late
LATE_SHARE = 0.01
# late answers and late samples, as the nodes that are the clock count them
_LATE = {
    'late_voltages': 'voltages came after the period that they were for',
    'late_samples': 'samples were taken a period or more too late',
}


def shortfalls(recording: Recording, evaluation: Evaluation | None = None) -> list[str]:
    """Sentences about what makes a run worthless, the most important first; empty for a sound run.

    A run with the law `off` is not meant to attenuate anything; nor is one without CONTROL whose scenario is not known.

    Args:
        recording: the run.
        evaluation: its figures; None: whether anything shook the payload is not looked at.
    """
    control = recording.phase == Phase.CONTROL
    scenario = recording.scenario
    if scenario and scenario.controller.get('law') == 'off':
        return _late(recording)
    if not control.any():
        return [*_no_control(recording), *_late(recording)]
    shaken = _no_disturbance(evaluation) if evaluation else []
    return [*shaken, *_no_model(recording), *_no_voltage(recording, control), *_late(recording)]


def _no_control(recording: Recording) -> list[str]:
    """Say that no sample was under control, where some were to be."""
    begins = recording.plan.first_of(Phase.CONTROL)
    if begins is not None:
        at = begins * recording.sample_period
        return [f'Nothing is under control: the recording has no sample of CONTROL, from {at:g} s.']
    if recording.scenario is None:
        return []
    return [
        'Nothing is under control: the scenario has no phase CONTROL (controller.law=off says that none is meant).'
    ]


def _no_disturbance(evaluation: Evaluation) -> list[str]:
    """Say that nothing shook the payload while the law acted, as the open-loop twin shows."""
    span = evaluation.windows.controlled
    if span is None or not evaluation.at_rest.all():
        return []
    where = ''
    if evaluation.windows.uncontrolled:
        where = f' in the stretch under control, {span[0]:g} to {span[1]:g} s'
    return [f'There was no disturbance{where}, so there is nothing to attenuate.']


def _no_model(recording: Recording) -> list[str]:
    """Say that no identified model was trusted, where the law refused to act for that reason."""
    if not recording.has('model', 'converged') or recording.get('model', 'converged').any():
        return []
    why = _last_reasons(recording)
    if not why:
        return []
    return [f'No strut has a model that is trusted: {why}.']


def _no_voltage(recording: Recording, control: Mask) -> list[str]:
    """Say that no strut had any voltage under control."""
    if not recording.has('voltage', 'voltage'):
        return []
    voltage = np.nan_to_num(recording.get('voltage', 'voltage')[control])
    if voltage.any():
        return _not_applied(recording, control)
    why = _last_reasons(recording)
    where = 'The voltage was 0 V at every strut, from the first sample of CONTROL to the last'
    return [f'{where}: {why}.' if why else f'{where}.']


def _not_applied(recording: Recording, control: Mask) -> list[str]:
    """Say that the laws asked for voltages and no coil got one, where the source of the samples says it."""
    if not recording.has('acceleration', 'applied_state'):
        return []
    # a sample says it of the sample before
    state = recording.get('acceleration', 'applied_state')[1:][control[:-1]]
    applied = recording.get('acceleration', 'applied')[1:][control[:-1]]
    known = np.nan_to_num(state) != Applied.UNKNOWN
    if not known.any() or np.nan_to_num(applied[known]).any():
        return []
    why = '; '.join(sorted({TEXTS[Applied(int(s))] for s in np.unique(state[known])} - {''}))
    where = 'No coil got any voltage of CONTROL, though the laws asked for some'
    return [f'{where}: {why}.' if why else f'{where}.']


def _last_reasons(recording: Recording) -> str:
    if not recording.has('state', 'reason'):
        return ''
    return '; '.join(sorted({str(text) for text in recording.get('state', 'reason')[-1] if text}))


def _late(recording: Recording) -> list[str]:
    """Say that the graph did not keep its pace: then the figures are those of the machine, not of the law."""
    sentences = []
    samples = len(recording.sequence)
    for name, what in _LATE.items():
        of = samples * (len(recording.struts) if name == 'late_voltages' else 1)
        late = sum(count for key, count in recording.counts.items() if key.endswith(name))
        if late > LATE_SHARE * of:
            sentences.append(f'{late} of {of} {what} ({100.0 * late / of:.1f} %).')
    return sentences
