# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""result.json: the report's figures for machines. The keys are described in docs/result.md and stay."""

import json
import math
import platform
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.errors import SatvibError

from satvib_experiment.analysis.evaluation import KINDS
from satvib_experiment.analysis.shortfalls import shortfalls
from satvib_experiment.report.comparison import plain
from satvib_experiment.report.context import Context
from satvib_experiment.report.judged import judged, worse_pointing
from satvib_experiment.report.models import model_summary

FORMAT = 'satvib result 1'


def result_mapping(context: Context) -> dict[str, Any]:
    """Give everything that the report says, as plain data; what is unknown is None."""
    recording, e = context.recording, context.evaluation
    scenario = recording.scenario
    figures = judged(context)
    return _plain(
        {
            'format': FORMAT,
            'scenario': recording.name or None,
            'seed': recording.seed,
            'source': recording.source,
            'realtime': recording.realtime,
            'sample_period': recording.sample_period,
            'samples': len(recording.sequence),
            'first_sequence': recording.sequence[0],
            'windows': {
                'uncontrolled': e.windows.uncontrolled,
                'controlled': e.windows.controlled,
            },
            'frequencies': e.frequencies,
            'sensor_noise': e.noise,
            'struts': [_strut(context, i) for i in range(len(context.struts))],
            **figures,
            'reference_source': e.reference_source or None,
            'lost': recording.lost(),
            'counts': recording.counts,
            'shortfalls': shortfalls(recording, e),
            'notes': [*worse_pointing(figures), *e.notes],
            'comparison': plain(context.comparison) or None,
            'phases': [
                {'phase': phase.name, 'start': start, 'end': end}
                for phase, start, end in recording.phases()
            ],
            'settings': scenario.to_mapping() if scenario else None,
            'rig': recording.rig.to_mapping() if recording.rig else None,
            'versions': versions(),
        }
    )


def _strut(context: Context, i: int) -> dict[str, Any]:
    e = context.evaluation
    return {
        'name': context.struts[i],
        'attenuation': {kind: e.attenuation[kind][i] for kind in KINDS},
        'attenuation_open_loop': {kind: e.attenuation_open_loop[kind][i] for kind in KINDS},
        'level': {
            window: {kind: level[kind][i] for kind in KINDS} for window, level in e.levels.items()
        },
        'noise_floor': {kind: floor[i] for kind, floor in e.floor.items()},
        'reference': e.reference[i] if i < len(e.reference) else None,
        'settling_time': e.settling_time[i],
        'largest_amplification': e.largest_amplification[i],
        'largest_voltage': e.largest_voltage[i],
        'saturated_share': e.saturated_share[i],
        'clipped': {sensor: counts[i] for sensor, counts in e.clipped.items()},
        'model': model_summary(context, i),
    }


def versions() -> dict[str, str]:
    """Versions of what computed this."""
    found = {'python': platform.python_version()}
    for name in ('satvib_bringup', 'numpy', 'scipy', 'numba', 'matplotlib'):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = 'source'
    return found


def _plain(value: Any) -> Any:
    """Turn arrays into lists and what is not finite into None, for strict JSON."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def write_result(context: Context, path: Path) -> dict[str, Any]:
    """Write result.json and give what it holds.

    Raises:
        SatvibError: it exists already or cannot be written.
    """
    mapping = result_mapping(context)
    try:
        with path.open('x', encoding='utf-8') as sink:
            json.dump(mapping, sink, indent=1, allow_nan=False)
            sink.write('\n')
    except FileExistsError:
        raise SatvibError(f'{path}: exists already, not overwritten') from None
    except OSError as error:
        raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None
    return mapping
