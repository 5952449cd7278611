# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Failures: what changes or fails in a run, and when.

    failures:
      - {kind: actuator_lost, strut: 1, time: 12.0}
      - {kind: sensor_lost, strut: 2, time: 12.0}
      - {kind: rig_changed, time: 12.0, changes: {payload.mass: 11.7}}
      - {kind: disturbance_changed, time: 12.0, disturbance: {kind: sine, frequency: 11, amplitude: 0.5}}
      - {kind: controller_killed, strut: 1, time: 12.0}

A failure takes effect at the sample nearest to its time, and stays. A lost actuator is a coil that is open: no force
and no back-EMF. A lost sensor reads NaN at the upper plate. A killed controller sends nothing more: the board holds
its last voltage for the command timeout, and then ramps it to 0 V over that same time (see `commands`). Without `strut`
the controllers of all struts are killed, as a centralized controller serves all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param
from satvib_common.settings_text import change_existing

from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.rig.any_rig import AnyRig, strut_count
from satvib_plant_sim.rig.rig import Rig

ACTUATOR, SENSOR, RIG, DISTURBANCE, CONTROLLER = KINDS = (
    'actuator_lost', 'sensor_lost', 'rig_changed', 'disturbance_changed', 'controller_killed',
)  # fmt: skip
_MAY_CHANGE = (
    'payload', 'struts', 'coil', 'accelerometer.range', 'accelerometer.bandwidth',
    'accelerometer.scale', 'acquisition.input_delay', 'acquisition.periods_late',
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Failure(Schema):
    """One failure."""

    kind: str = param(description='what', choices=KINDS)
    time: float = param(description='when', unit='s', minimum=0.0)
    strut: int = param(0, 'strut, from 1; 0: none or all', minimum=0)
    changes: dict[str, Any] = param(dict, 'rig_changed: new values by dotted key, as in a rig')
    disturbance: dict[str, Any] = param(dict, 'disturbance_changed: the new one, times from 0')

    def check(self) -> None:
        """Refuse keys that the kind does not have, and those that it lacks."""
        needed = {ACTUATOR: 'strut', SENSOR: 'strut', RIG: 'changes', DISTURBANCE: 'disturbance'}
        own = needed.get(self.kind)
        if own is not None and not getattr(self, own):
            raise SatvibError(f'{own}: missing, {self.kind} needs it')
        for name in ('strut', 'changes', 'disturbance'):
            if getattr(self, name) and name != own and (self.kind, name) != (CONTROLLER, 'strut'):
                raise SatvibError(f'{name}: {self.kind} has no such key')
        if self.disturbance:
            make_disturbance(self.disturbance)
        for key in self.changes:
            if key not in _MAY_CHANGE and key.split('.')[0] not in _MAY_CHANGE:
                raise SatvibError(
                    f'changes.{key}: only {", ".join(_MAY_CHANGE)} can change in a run'
                )

    def sample(self, dt: float) -> int:
        """Sample at which it takes effect; `dt` in s."""
        return round(self.time / dt)

    def apply(self, rig: AnyRig) -> AnyRig:
        """Give the rig after it.

        Raises:
            SatvibError: the rig has no such strut or key.
        """
        if self.kind not in {ACTUATOR, RIG}:
            return rig
        if not isinstance(rig, Rig):
            raise SatvibError(f'{self.kind}: a rig of identified models cannot change')
        if self.kind == RIG:
            data = change_existing(rig.to_mapping(), self.changes, 'changes')
            return Rig.from_mapping(data, 'changes')
        scale = list(rig.coil.force_scale)
        scale[self.strut - 1] = 0.0
        return rig.replace(coil=rig.coil.replace(force_scale=tuple(scale)))


def check_failures(failures: Sequence[Failure], rig: AnyRig, duration: float) -> None:
    """Refuse failures that a rig or a run of `duration` s cannot have.

    Raises:
        SatvibError: which one, and why.
    """
    count = strut_count(rig)
    for i, failure in enumerate(failures):
        where = f'failures[{i}]'
        if failure.strut > count:
            raise SatvibError(f'{where}.strut: {failure.strut}, but {rig.name} has {count}')
        if failure.time >= duration:
            raise SatvibError(f'{where}.time: {failure.time} s, the run ends at {duration} s')
        try:
            failure.apply(rig)
        except SatvibError as error:
            raise SatvibError(f'{where}.{error}') from None
