# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Input and output of a strut for offline identification, from a CSV file or from a recorded run."""

from dataclasses import dataclass
from pathlib import Path

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.files.csv_columns import read_columns
from satvib_common.phases import Phase

from satvib_experiment.recording.load import load_recording
from satvib_experiment.recording.signals import without_bias


@dataclass(frozen=True)
class InputOutput:
    """What is identified.

    Attributes:
        u: (samples) input, V.
        y: (samples) output, m/s^2.
        dt: s.
        delay: samples from an input to the first output that it reaches, if nobody says otherwise.
        name: for people.
    """

    u: Array
    y: Array
    dt: float
    delay: int
    name: str


def read_csv(
    path: Path, input_column: str | None, output_column: str | None, dt: float | None
) -> InputOutput:
    """Read two columns of a CSV file; without a sample period, one sample is one second.

    Raises:
        SatvibError: a column is not named, not there, or holds something else than numbers.
    """
    if not input_column or not output_column:
        raise SatvibError(f'{path}: name the columns of a CSV file with --input and --output')
    u, y = read_columns(path, [input_column, output_column])
    return InputOutput(u, y, dt or 1.0, 0, path.name)


def read_strut(path: Path, strut_number: int) -> InputOutput:
    """Take the IDENTIFY phase of a recorded run, or all of it when there was none.

    Args:
        path: bag, folder of a run, or recording.npz.
        strut_number: from 1.

    Raises:
        SatvibError: no such strut, or nothing recorded to identify from.
    """
    recording = load_recording(path)
    count = len(recording.struts)
    if not 1 <= strut_number <= count:
        raise SatvibError(f'--strut: {strut_number} is not one of the {count} struts of {path}')
    spans = [(s, e) for phase, s, e in recording.phases() if phase is Phase.IDENTIFY]
    window = recording.window(*spans[0]) if spans else slice(None)
    u = recording.get('voltage', 'voltage')[window, strut_number - 1]
    y = without_bias(recording, window)[:, strut_number - 1]
    name = f'{recording.struts[strut_number - 1]} of {path}'
    return InputOutput(u, y, recording.sample_period, 1, name)
