# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A batch of trials: one rig, one disturbance and one seed each."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema

from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.rig.rig import Rig

AnyRig = TypeVar('AnyRig', bound=Schema)


def trials_of(
    rig: AnyRig | Sequence[AnyRig],
    disturbance: Disturbance | Sequence[Disturbance],
    seed: int | Sequence[int],
) -> tuple[list[AnyRig], list[Disturbance], list[int], tuple[int, ...]]:
    """Bring the three to one length.

    Returns:
        The three as lists, and the shape: () when all were single, else (trials,).

    Raises:
        SatvibError: lengths that do not fit, a seed below 0.
    """
    rigs = [rig] if isinstance(rig, Schema) else list(rig)
    disturbances = [disturbance] if isinstance(disturbance, Disturbance) else list(disturbance)
    seeds = [int(seed)] if isinstance(seed, int | np.integer) else [int(s) for s in seed]
    single = (
        isinstance(rig, Schema)
        and isinstance(disturbance, Disturbance)
        and isinstance(seed, int | np.integer)
    )
    lengths = {len(rigs), len(disturbances), len(seeds)}
    count = max(lengths)
    if lengths - {1, count} or 0 in lengths:
        told = f'{len(rigs)} rigs, {len(disturbances)} disturbances and {len(seeds)} seeds'
        raise SatvibError(f'plant: {told} do not make a batch')
    if min(seeds) < 0:
        raise SatvibError(f'plant: seed {min(seeds)} is less than 0')
    return (
        rigs * (count // len(rigs)),
        disturbances * (count // len(disturbances)),
        seeds * (count // len(seeds)),
        () if single else (count,),
    )


def agree(rigs: Sequence[Rig]) -> None:
    """Refuse a batch whose trials do not run in step."""
    require_equal('struts.count', {r.struts.count for r in rigs})
    require_equal('struts.each (listed struts)', {len(r.struts.each) for r in rigs})
    require_equal('acquisition.sample_rate', {r.acquisition.sample_rate for r in rigs})
    steps = {r.acquisition.fine_steps for r in rigs}
    require_equal('acquisition.fine_rate (as fine steps)', steps)
    require_equal('acquisition.filter_order', {r.acquisition.filter_order for r in rigs})


def require_equal(label: str, values: set[float] | set[int]) -> None:
    """Refuse more than one value of what a batch must share."""
    if len(values) > 1:
        told = ', '.join(map(str, sorted(values)))
        raise SatvibError(f'plant: the rigs of a batch differ in {label}: {told}')


def checked_voltage(voltage: np.typing.ArrayLike, shape: tuple[int, ...], sequence: int) -> Array:
    """Give the voltages as an array of a shape (..., struts).

    Raises:
        SatvibError: another shape, or a voltage that is not a finite number.
    """
    asked = np.asarray(voltage, dtype=float)
    if asked.shape != shape:
        raise SatvibError(f'voltage: shape {asked.shape}, not {shape}')
    if not np.isfinite(asked).all():
        where = tuple(np.argwhere(~np.isfinite(asked))[0])
        raise SatvibError(f'voltage: {asked[where]} for strut {where[-1] + 1} at sample {sequence}')
    return asked
