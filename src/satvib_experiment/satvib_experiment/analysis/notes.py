# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a reader of the figures must know, in sentences."""

import numpy as np
from satvib_common.arrays import Mask

from satvib_experiment.analysis.evaluation import Evaluation
from satvib_experiment.recording.recording import Recording

# measured and true attenuation that differ by more than this are worth a sentence
APART = 3.0

# dB; less is no change
_NOTABLE = 0.1

_NAMES = {'rms': 'RMS', 'tone': 'tone'}


def notes_for(recording: Recording, evaluation: Evaluation) -> list[str]:
    """Sentences about a run, the most important first."""
    return [
        *recording.notes,
        *_unmeasured(recording),
        *_apart(evaluation),
        *_worse(evaluation),
        *_clipping(recording, evaluation),
        *_limits(evaluation),
        *_reasons(recording),
        *_losses(recording),
        *_missing(recording, evaluation),
    ]


def _unmeasured(recording: Recording) -> list[str]:
    """Name the sensors that gave no number in the whole recording, although there are messages."""
    by_struts: dict[str, list[str]] = {}
    there = recording.get('acceleration', 'present')
    for plate in ('upper', 'lower'):
        if recording.has('acceleration', plate):
            known = np.any(np.isfinite(recording.get('acceleration', plate)) & there, axis=0)
            silent = np.flatnonzero(there.any(axis=0) & ~known)
            struts = ', '.join(recording.struts[i].replace('_', ' ') for i in silent)
            by_struts.setdefault(struts, []).append(plate)
    return [
        f'Not measured, NaN throughout: the {" and the ".join(plates)} acceleration of {struts}.'
        for struts, plates in by_struts.items()
        if struts
    ]


def _apart(evaluation: Evaluation) -> list[str]:
    """Name the struts whose measured attenuation is not the true one."""
    sentences = []
    for name, word in _NAMES.items():
        measured = evaluation.attenuation[f'measured_{name}']
        true = evaluation.attenuation[f'true_{name}']
        apart = np.abs(measured - true) > APART
        if not np.any(apart):
            continue
        pairs = '; '.join(
            f'{_label(evaluation, i)} {measured[i]:+.1f} dB measured, {true[i]:+.1f} dB true'
            for i in np.flatnonzero(apart)
        )
        optimistic = np.all(measured[apart] < true[apart])
        meaning = (
            'The samples show more attenuation than there is'
            if optimistic
            else "The loop's own samples do not show what happens between them"
        )
        sentences.append(
            f'Measured and true attenuation of the {word} differ by more than {APART:.0f} dB: '
            f'{pairs}. {meaning}; judge by the true figures.'
        )
    return sentences


def _label(evaluation: Evaluation, i: np.intp) -> str:
    return evaluation.struts[i].replace('_', ' ')


def _listed(evaluation: Evaluation, where: Mask) -> str:
    return ', '.join(_label(evaluation, i) for i in np.flatnonzero(where))


def _worse(evaluation: Evaluation) -> list[str]:
    true, measured = evaluation.attenuation['true_rms'], evaluation.attenuation['measured_rms']
    known = np.where(np.isfinite(true), true, measured)
    worse = known > _NOTABLE
    if not np.any(worse):
        return []
    largest = np.nanmax(known)
    return [
        (
            f'Control makes the vibration of the payload worse at {_listed(evaluation, worse)} '
            f'(by up to {largest:.1f} dB in RMS).'
        )
    ]


def _clipping(recording: Recording, evaluation: Evaluation) -> list[str]:
    """Name the struts whose sensors stood at an end of their range: there the samples say less than there was."""
    sentences = []
    for sensor, counts in evaluation.clipped.items():
        if not np.any(counts):
            continue
        listed = '; '.join(
            f'{_label(evaluation, i)} {counts[i]} of {len(recording.sequence)} samples'
            for i in np.flatnonzero(counts)
        )
        sentences.append(
            f'The {sensor} sensor clipped at an end of its range: {listed}. There the acceleration was larger than '
            'measured; judge by the true figures, or take a sensor with a larger range.'
        )
    return sentences


def _limits(evaluation: Evaluation) -> list[str]:
    share = evaluation.saturated_share
    if not np.any(share > 0.01):
        return []
    return [
        (
            f'The voltage guard stepped in on up to {100 * np.nanmax(share):.0f} % of the samples '
            'under control; the law did not get the voltage that it asked for.'
        )
    ]


def _reasons(recording: Recording) -> list[str]:
    """Say why a controller did not act or adapt, as it stood at the end."""
    sentences = []
    if recording.has('state', 'reason'):
        present = recording.get('state', 'present')
        rows = len(present) - 1 - np.argmax(present[::-1], axis=0)
        last = recording.get('state', 'reason')[rows, np.arange(present.shape[1])]
        by_text: dict[str, list[str]] = {}
        for strut, text in zip(recording.struts, last, strict=True):
            if text:
                by_text.setdefault(str(text), []).append(strut.replace('_', ' '))
        sentences += [
            f'Controller of {", ".join(struts)}: {text}.' for text, struts in by_text.items()
        ]
    return sentences


def _losses(recording: Recording) -> list[str]:
    sentences = []
    lost = {group: count for group, count in recording.lost().items() if count}
    if lost:
        listed = ', '.join(f'{count} of {group}' for group, count in lost.items())
        sentences.append(f'Messages are missing from the recording: {listed}.')
    counted = {name: count for name, count in recording.counts.items() if count}
    if counted:
        listed = ', '.join(f'{name.replace("_", " ")} {count}' for name, count in counted.items())
        sentences.append(f'Lost, late or repeated on the way: {listed}.')
    return sentences


def _missing(recording: Recording, evaluation: Evaluation) -> list[str]:
    sentences = []
    if not recording.has('truth'):
        sentences.append(
            'There is no truth between the samples in this recording; the measured figures cannot '
            'be checked against it.'
        )
    if evaluation.windows.controlled is None:
        sentences.append('The run has no stretch under control; there is nothing to compare.')
    elif evaluation.windows.uncontrolled is None and not evaluation.at_rest.all():
        sentences.append(
            'The run has no stretch with the disturbance and without control; attenuation is '
            'against its open-loop twin.'
        )
    return sentences
