# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a scenario's disturbance says about its tones and its beginning, read from its mapping."""

from collections.abc import Iterator, Mapping
from typing import Any


def _parts(disturbance: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """A disturbance, or the parts of a sum."""
    parts = disturbance.get('parts') if disturbance.get('kind') == 'sum' else None
    if parts:
        for part in parts:
            yield from _parts(part)
    else:
        yield disturbance


def disturbance_tones(disturbance: Mapping[str, Any]) -> list[float]:
    """Frequencies of the steady tones, Hz, increasing; empty for a disturbance without any."""
    found: set[float] = set()
    for part in _parts(disturbance):
        if part.get('kind') == 'sine':
            found.add(float(part['frequency']))
        elif part.get('kind') == 'tones':
            found.update(float(f) for f in part['frequencies'])
    return sorted(found)


def disturbance_onset(disturbance: Mapping[str, Any]) -> float:
    """When the first part begins, s."""
    return min(float(part.get('start', 0.0)) for part in _parts(disturbance))
