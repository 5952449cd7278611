# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Disturbances by name, every key checked."""

from collections.abc import Mapping
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.schema import shown

from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.combined import Sum
from satvib_plant_sim.disturbance.random import Random
from satvib_plant_sim.disturbance.reaction_wheel import MountedWheel, ReactionWheel
from satvib_plant_sim.disturbance.shapes import Burst, Pulse, Trapezoid
from satvib_plant_sim.disturbance.silence import Silence
from satvib_plant_sim.disturbance.sine import Sine
from satvib_plant_sim.disturbance.sweep import SteppedSine, Sweep
from satvib_plant_sim.disturbance.tones import Multisine, Tones

_KINDS: dict[str, type[Disturbance]] = {
    'none': Silence,
    'sine': Sine,
    'tones': Tones,
    'multisine': Multisine,
    'sweep': Sweep,
    'stepped_sine': SteppedSine,
    'random': Random,
    'reaction_wheel': ReactionWheel,
    'mounted_wheel': MountedWheel,
    'pulse': Pulse,
    'trapezoid': Trapezoid,
    'burst': Burst,
    'sum': Sum,
}


def disturbance_kinds() -> list[str]:
    """Give the names of the kinds."""
    return list(_KINDS)


def make_disturbance(settings: Any, where: str = 'disturbance') -> Disturbance:
    """Build a disturbance from plain data (as YAML gives it), or give back one that is built already.

    Args:
        settings: a mapping with `kind` and the kind's own keys; None is no disturbance.
        where: the start of the message when something is wrong.

    Raises:
        SatvibError: an unknown kind or key, a wrong type, a value out of range.
    """
    if settings is None:
        return Silence()
    if isinstance(settings, Disturbance):
        return settings
    if not isinstance(settings, Mapping):
        raise SatvibError(
            f'{where}: a mapping with the key kind is expected, not {shown(settings)}'
        )
    kind = settings.get('kind')
    if not isinstance(kind, str) or kind not in _KINDS:
        what = 'kind: missing' if kind is None else f'kind: {shown(kind)} is not known'
        raise SatvibError(f'{where}: {what} (kinds: {", ".join(_KINDS)})')
    if kind == 'sum':
        settings = _with_terms(settings, where)
    return _KINDS[kind].from_mapping(settings, where)


def _with_terms(settings: Mapping[str, Any], where: str) -> Mapping[str, Any]:
    """Build the terms of a sum first, so that a message names the term that is wrong."""
    terms = settings.get('terms')
    if not isinstance(terms, list | tuple):
        return settings
    built = [make_disturbance(term, f'{where}: terms[{i}]') for i, term in enumerate(terms)]
    return {**settings, 'terms': tuple(built)}
