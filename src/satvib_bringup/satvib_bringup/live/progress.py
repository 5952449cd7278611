# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a live run reports while it goes and when it is over."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from satvib_common.phases import Phase


@dataclass(frozen=True)
class Progress:
    """Where a run is.

    Attributes:
        phase: of the newest sample that was seen.
        sequence: of that sample.
        end: number of samples of the run.
        time: s since the start of the experiment.
        attenuation: dB per strut, as in `satvib_experiment.analysis.running_attenuation`; NaN where there is none.
        speed: times real time, on average since the start.
    """

    phase: Phase
    sequence: int
    end: int
    time: float
    attenuation: tuple[float, ...]
    speed: float


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Attributes:
        success: everything ended as it should and the recording is complete.
        exit_code: 0; 1: the run failed; 2: something that a person must correct.
        message: one line.
        folder: of the run: parameters, logs, bag.
        bag: the bag's folder, None when there is none.
        struts: names.
        samples: of the run, as far as it came.
        wall_time: s from the schedule to the plant's end.
        recording: per topic what was written and lost, as the recorder reports it.
    """

    success: bool
    exit_code: int
    message: str
    folder: Path
    bag: Path | None
    struts: tuple[str, ...]
    samples: int = 0
    wall_time: float = 0.0
    recording: dict[str, Any] = field(default_factory=dict)
