# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The state of a particle swarm in a file, so that a search that was interrupted goes on where it was."""

import json
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.files.npz_file import load_npz_arrays
from satvib_common.files.whole_file import write_whole

_FORMAT = 'satvib swarm 1'
_ARRAYS = ('position', 'velocity', 'best_position', 'best_cost', 'position_found')
_NUMBERS = ('cost_found', 'steps', 'evaluations', 'still', 'rounds', 'mark', 'round_mark')
_MAY_DIFFER = {'budget', 'patience', 'target'}  # when to stop may be changed on the way


class Swarm(Protocol):
    """What is kept of a swarm: besides these the arrays and numbers named above."""

    settings: Any
    lower: Array
    upper: Array
    history: list[tuple[float, float]]


def _search(swarm: Swarm) -> dict[str, object]:
    """What two runs must share to be one search."""
    settings = {k: v for k, v in swarm.settings.to_mapping().items() if k not in _MAY_DIFFER}
    return settings | {'lower': swarm.lower.tolist(), 'upper': swarm.upper.tolist()}


def save(swarm: Swarm, path: Path) -> None:
    """Write the state of a swarm; what was there is replaced.

    Raises:
        SatvibError: it cannot be written.
    """
    numbers = {name: float(getattr(swarm, name)) for name in _NUMBERS}
    about = json.dumps({'format': _FORMAT, 'search': _search(swarm), 'numbers': numbers})
    arrays = {name: getattr(swarm, name) for name in _ARRAYS}
    arrays |= {'about': np.array(about), 'history': np.array(swarm.history)}
    write_whole(path, lambda sink: np.savez(sink, allow_pickle=False, **arrays))


def restore(swarm: Swarm, path: Path) -> None:
    """Bring a swarm into the state of a file.

    Raises:
        SatvibError: the file is broken, or of another search.
    """
    try:
        arrays = load_npz_arrays(path)
        about = json.loads(str(arrays['about']))
        if about['format'] != _FORMAT:
            raise ValueError(about['format'])
        search, numbers = about['search'], about['numbers']
        shapes_fit = all(arrays[n].shape == getattr(swarm, n).shape for n in _ARRAYS)
        history = arrays['history'].reshape(-1, 2)
        found = {name: float(numbers[name]) for name in _NUMBERS}
    except (SatvibError, ValueError, KeyError, TypeError, OverflowError):
        raise SatvibError(
            f'{path}: not a checkpoint of a search, or broken; remove it to begin again'
        ) from None
    if search != _search(swarm) or not shapes_fit:
        now = _search(swarm)
        differing = sorted(k for k in now if search.get(k) != now[k]) or ['shape']
        raise SatvibError(
            f'{path}: a checkpoint of another search, {", ".join(differing)} differ; remove it '
            'or name another file'
        )
    for name in _ARRAYS:
        setattr(swarm, name, arrays[name])
    for name in _NUMBERS:
        whole = name in {'steps', 'evaluations', 'still', 'rounds'}
        setattr(swarm, name, int(found[name]) if whole else found[name])
    swarm.history = [(float(n), float(c)) for n, c in history]
