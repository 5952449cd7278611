# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A measured record as the samples of a strut: what goes out with sample k, and how far ahead it may go.

The input of the record plays the voltage, its output the upper acceleration. A record whose columns are rows of the
same instant has delay 0: y(k) already sees u(k).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_common.records.any_file import has_columns
from satvib_common.records.record import column_record
from satvib_common.schema import Fixed, Schema, param


@dataclass(frozen=True, kw_only=True)
class ReplayParameters(Schema):
    """Which record, and how fast."""

    file: str = param(
        '',
        'file of columns (CSV, LVM, TDMS, MAT, UFF, WAV, Parquet ...), or a bag of satvib',
        read_only=Fixed.START,
    )
    input: str = param(
        'input', 'file of columns: that of the input (voltage)', read_only=Fixed.START
    )
    output: str = param(
        'output', 'file of columns: that of the output (upper acceleration)', read_only=Fixed.START
    )
    strut: str = param(
        'strut_1',
        'strut as which it is published; of a bag, the strut that is read',
        read_only=Fixed.START,
    )
    sample_rate: float = param(
        100.0, 'sample rate of a file of columns; a bag knows its own', unit='Hz', above=0.0,
        read_only=Fixed.START,
    )  # fmt: skip
    speed: float = param(
        0.0,
        'times real time; 0: as fast as the identifier follows',
        minimum=0.0,
        maximum=1e4,
        read_only=Fixed.START,
    )
    window: int = param(
        200, 'samples that may be ahead of the identifier at speed 0', minimum=1, maximum=900,
        read_only=Fixed.START,
    )  # fmt: skip
    phase: str = param(
        'IDENTIFY',
        'phase of all samples',
        choices=tuple(p.name for p in Phase),
        read_only=Fixed.START,
    )

    def check(self) -> None:
        """A file is needed."""
        if not self.file:
            raise SatvibError(
                'file: missing; give a file of columns or a bag, as in -p file:=record.csv'
            )


@dataclass(frozen=True)
class ReplayRecord:
    """A measured record.

    Attributes:
        upper, lower, voltage: (samples,) m/s^2, m/s^2, V; NaN where not known.
        period: s.
        plan: phases by sample.
        notes: what was found in a file of columns, a sentence each.
    """

    upper: Array
    lower: Array
    voltage: Array
    period: float
    plan: PhasePlan
    notes: tuple[str, ...] = ()

    @property
    def is_answered(self) -> bool:
        """Whether an identifier answers every sample with a model."""
        return self.plan.phases == (Phase.IDENTIFY,)


def load_record(parameters: ReplayParameters) -> ReplayRecord:
    """Read the record.

    Raises:
        SatvibError: no such file, column or strut; numbers that are none.
    """
    p = parameters
    path = Path(p.file)
    if has_columns(path, columns_given=False):
        measured = column_record(path, p.input, p.output, 1.0 / p.sample_rate)
        plan = PhasePlan((Phase[p.phase],), (0,), len(measured.y))
        nothing = np.full(len(measured.y), np.nan)
        return ReplayRecord(
            measured.y, nothing, measured.u, measured.dt, plan, tuple(measured.notes)
        )
    return _from_bag(path, p.strut)


def _from_bag(path: Path, strut_name: str) -> ReplayRecord:
    from satvib_experiment.recording.bag_reader import read_recording

    recording = read_recording(path)
    if strut_name not in recording.struts:
        raise SatvibError(f'{path}: no {strut_name} in it; there are {", ".join(recording.struts)}')
    i = recording.struts.index(strut_name)

    def column(group: str, name: str) -> Array:
        return np.asarray(recording.get(group, name)[:, i], dtype=float)

    return ReplayRecord(
        column('acceleration', 'upper'),
        column('acceleration', 'lower'),
        column('voltage', 'voltage'),
        recording.sample_period,
        recording.plan,
    )
