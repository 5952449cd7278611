# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the plant_sim node."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import parse_yaml
from satvib_common.schema import Fixed, Schema, param
from satvib_common.settings_text import parse_settings

from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.plant.any_plant import AnyPlant
from satvib_plant_sim.plant.failing_plant import FailingPlant, make_failing_plant
from satvib_plant_sim.plant.failures import Failure
from satvib_plant_sim.rig.any_rig import AnyRig, load_any_rig
from satvib_plant_sim.rig.fine_grid import fitted_grid
from satvib_plant_sim.rig.rig import Rig


@dataclass(frozen=True, kw_only=True)
class PlantParameters(Schema):
    """Rig, disturbance, failures, and how time passes."""

    rig: str = param('paper_3dof', 'name of a rig, or the path of its file', read_only=Fixed.START)
    rig_overrides: tuple[str, ...] = param(
        (), "changes to the rig, each 'key=value' as in 'payload.mass=12'", read_only=Fixed.START
    )
    disturbance: str = param(
        'kind: none',
        'the disturbance as YAML text: -p "disturbance:=\'{kind: sine, amplitude: 1, frequency: 10}\'"',
        read_only=Fixed.START,
    )
    failures: str = param(
        '[]',
        'what goes wrong as YAML text: -p "failures:=\'[{kind: sensor_lost, strut: 1, time: 5}]\'"',
        read_only=Fixed.START,
    )
    seed: int = param(
        1, 'seed of noise, bias and random disturbances', minimum=0, read_only=Fixed.START
    )
    lockstep: bool = param(
        True,
        'wait for every voltage of a sample before the next; false: real time',
        read_only=Fixed.GRAPH,
    )
    lockstep_timeout: float = param(
        10.0, 'longest wait for a voltage in lockstep', unit='s', above=0.0
    )
    command_timeout: float = param(
        0.05,
        'real time: without a voltage for this long, 0 V; a voltage that answers an older sample does not count',
        unit='s',
        above=0.0,
    )
    after_silence: str = param(
        'resume',
        'real time, after 0 V because no voltage came: resume: go on when voltages come again; '
        'latch: 0 V until reset',
        choices=('resume', 'latch'),
    )
    return_time: float = param(
        0.3, 'time over which a voltage rises from 0 V after a silence or a reset', unit='s',
        minimum=0.0, maximum=60.0,
    )  # fmt: skip
    truth_period: float = param(
        0.05, 'length of the blocks in which the truth is published; 0: every sample by itself',
        unit='s', minimum=0.0, maximum=60.0, read_only=Fixed.START,
    )  # fmt: skip
    arrival_file: str = param(
        '', 'real time: .npz file for the arrivals of the voltages after their samples; empty: none',
        read_only=Fixed.START,
    )  # fmt: skip
    wait_for_schedule: bool = param(
        True, 'begin with sample 0 when the schedule is there', read_only=Fixed.START
    )

    def check(self) -> None:
        """Refuse overrides without a key and a disturbance that is not one."""
        self.override_mapping()
        self.make_disturbance()
        self.make_failures()

    def override_mapping(self) -> dict[str, Any]:
        """Give the overrides as `load_rig` takes them; an empty string is nothing."""
        return parse_settings(self.rig_overrides, 'rig_overrides')

    def load_rig(self) -> AnyRig:
        """Load the rig with its overrides, its truth as fine as the disturbances need."""
        later = [make_disturbance(f.disturbance) for f in self.make_failures() if f.disturbance]
        rig = load_any_rig(self.rig, self.override_mapping())
        return fitted_grid(rig, [self.make_disturbance(), *later])

    def make_disturbance(self) -> Disturbance:
        """Build the disturbance."""
        return make_disturbance(parse_yaml(self.disturbance, 'disturbance'))

    def make_failures(self) -> tuple[Failure, ...]:
        """Build the failures."""
        data = parse_yaml(self.failures, 'failures') or []
        if not isinstance(data, list):
            raise SatvibError(f'failures: a list is expected, not {self.failures!r}')
        return tuple(Failure.from_mapping(d, f'failures[{i}]') for i, d in enumerate(data))

    def voltage_limit(self) -> float:
        """What the amplifiers of the rig can give, V; infinite where it has none."""
        rig = self.load_rig()
        return rig.coil.voltage_limit if isinstance(rig, Rig) else math.inf

    def make_plant(self) -> AnyPlant | FailingPlant:
        """Build the plant with its failures.

        For real time another one is run first and thrown away, so that no sample waits for code to be loaded.
        """
        setting = (self.load_rig(), self.make_disturbance(), self.seed, self.make_failures())
        if not self.lockstep:
            other = make_failing_plant(*setting)
            for _ in range(3):
                other.sample()
                other.advance(np.zeros(other.struts), np.zeros(other.struts))
        return make_failing_plant(*setting)
