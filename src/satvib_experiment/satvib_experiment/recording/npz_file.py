# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of the offline twin: reading what `Recording.save` wrote, every part of it checked."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.errors import SatvibError, printable
from satvib_common.files.npz_file import load_npz_arrays
from satvib_common.phases import Phase, PhasePlan
from satvib_plant_sim.rig.any_rig import rig_from_mapping

from satvib_experiment.recording.recording import FORMAT, Group, Recording
from satvib_experiment.scenario.scenario import Scenario

_PERIODS = (1e-7, 1e3)  # s
# what a file that was made by hand, or damaged, makes of the lines below
_NO_RECORDING = (ValueError, KeyError, TypeError, AttributeError, IndexError, OverflowError)


def load_npz(path: Path) -> Recording:
    """Read what `Recording.save` wrote.

    Raises:
        SatvibError: not there, or not such a file.
    """
    arrays = load_npz_arrays(path, 'a satvib recording')
    try:
        return _recording(arrays, path)
    except RecursionError:
        raise SatvibError(f'{path}: not a satvib recording: nested too deeply') from None
    except _NO_RECORDING as error:
        reason = printable(' '.join(str(error).split()), 200)
        raise SatvibError(f'{path}: not a satvib recording: {reason}') from None


def _recording(arrays: dict[str, NDArray[Any]], path: Path) -> Recording:
    about = json.loads(str(arrays.pop('about')))
    if about['format'] != FORMAT:
        raise ValueError(f'format {about["format"]}')
    sequence, stamp = arrays.pop('sequence'), arrays.pop('stamp')
    struts = tuple(about['struts'])
    if not struts or not all(isinstance(s, str) and s and s.isprintable() for s in struts):
        raise ValueError('no names of struts')
    count = len(sequence)
    is_row = sequence.ndim == 1 and sequence.dtype.kind == stamp.dtype.kind == 'i'
    if not is_row or not count or stamp.shape != sequence.shape or np.any(np.diff(sequence) != 1):
        raise ValueError('its samples are not consecutive')
    period = float(about['sample_period'])
    if not _PERIODS[0] <= period <= _PERIODS[1]:
        raise ValueError(f'sample period {period} s')
    groups: dict[str, Group] = {}
    for name, array in arrays.items():
        group, _, member = name.partition('/')
        if array.shape[:2] != (count, len(struts)):
            raise ValueError(
                f'{name}: shape {array.shape} for {count} samples and {len(struts)} struts'
            )
        groups.setdefault(group, {})[member] = array
    for name, fields in groups.items():
        if fields['present'].dtype != bool:
            raise ValueError(f'{name}/present is no mask')
    if 'acceleration' not in groups:
        raise ValueError('there is no acceleration in it')
    scenario, rig = about['scenario'], about['rig']
    return Recording(
        struts=struts,
        sample_period=period,
        plan=PhasePlan(
            tuple(Phase[name] for name in about['phases']),
            tuple(int(k) for k in about['first']),
            int(about['end']),
        ),
        sequence=sequence,
        stamp=stamp,
        groups=groups,
        scenario=Scenario.from_mapping(scenario, str(path)) if scenario else None,
        rig=rig_from_mapping(rig, str(path)) if rig else None,
        realtime=bool(about['realtime']),
        seed=int(about['seed']),
        source=printable(str(about['source'])),
        counts={str(name): int(number) for name, number in about['counts'].items()},
        name=printable(str(about.get('name', '')), 200),
        notes=[printable(str(note)) for note in about.get('notes', ())],
    )
