# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Input and output of a strut of a recorded run, for offline identification."""

from pathlib import Path

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_common.records.checks import check_signal
from satvib_common.records.record import MeasuredRecord

from satvib_experiment.recording.load import load_recording
from satvib_experiment.recording.signals import without_bias


def read_strut(path: Path, strut_number: int, recover: bool = False) -> MeasuredRecord:
    """Take the IDENTIFY phase of a recorded run, or all of it when there was none.

    Args:
        path: bag, folder of a run, or recording.npz.
        strut_number: from 1.
        recover: read what can be read of a damaged bag.

    Raises:
        SatvibError: no such strut, or nothing recorded to identify from.
    """
    recording = load_recording(path, recover)
    count = len(recording.struts)
    if not 1 <= strut_number <= count:
        raise SatvibError(f'--strut: {strut_number} is not one of the {count} struts of {path}')
    spans = [(s, e) for phase, s, e in recording.phases() if phase is Phase.IDENTIFY]
    window = recording.window(*spans[0]) if spans else slice(None)
    u = recording.get('voltage', 'voltage')[window, strut_number - 1]
    y = without_bias(recording, window)[:, strut_number - 1]
    notes = [note.rstrip('.') for note in recording.notes]
    if recording.has('acceleration', 'upper_clipped'):
        clipped = recording.get('acceleration', 'upper_clipped')[window, strut_number - 1]
        y = np.where(clipped, np.nan, y)
        if clipped.any():
            notes.append(
                f'{np.count_nonzero(clipped)} of {len(u)} samples clipped at an end of the range of the upper sensor: '
                'left out'
            )
    if gaps := int((~np.isfinite(u) | ~np.isfinite(y)).sum()):
        notes.append(f'{gaps} of {len(u)} samples lack a value: gaps; nothing is taken across them')
    notes += check_signal('input', u) + check_signal('output', y)
    return MeasuredRecord(
        u=u,
        y=y,
        dt=recording.sample_period,
        delay=1,
        name=f'{recording.struts[strut_number - 1]} of {path}',
        notes=notes,
    )
