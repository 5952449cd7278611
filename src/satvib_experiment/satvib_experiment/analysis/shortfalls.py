# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a run did what it was made for: a run under control that controlled nothing must not look like a success."""

import numpy as np
from satvib_common.arrays import Mask
from satvib_common.phases import Phase
from satvib_common.struts.applied import TEXTS, Applied

from satvib_experiment.recording.recording import Recording

# share of all answers, and of all samples, that may be late
LATE_SHARE = 0.01
# late answers and late samples, as the nodes that are the clock count them
_LATE = {
    'late_voltages': 'voltages came after the period that they were for',
    'late_samples': 'samples were taken a period or more too late',
}


def shortfalls(recording: Recording) -> list[str]:
    """Sentences about what makes a run worthless, the most important first; empty for a sound run.

    A run without CONTROL, or with the law `off`, is not meant to attenuate anything.
    """
    control = recording.phase == Phase.CONTROL
    scenario = recording.scenario
    meant = bool(control.any()) and not (scenario and scenario.controller.get('law') == 'off')
    acted = [*_no_model(recording), *_no_voltage(recording, control)] if meant else []
    return [*acted, *_late(recording)]


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
