# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A scenario: which rig, which phases, which disturbance, which identifier and law, and which seed.

    scenario = load_scenario('paper_3dof', ['seed=7', 'controller.law=velocity_feedback', 'rig.payload.mass=12'])
    plan = scenario.plan(rate)

Every key is checked when the scenario is loaded, the nested mappings by the package that they belong to, and the file
is named in the message.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from satvib_common.errors import SatvibError
from satvib_common.files.folder_name import check_folder_name
from satvib_common.phases import Phase, PhasePlan
from satvib_common.schema import Schema, param
from satvib_plant_sim.plant.failures import Failure, check_failures
from satvib_plant_sim.rig.any_rig import AnyRig, load_any_rig, strut_count

from satvib_experiment.scenario.centralized_scheme import centralized_parameters, take_gains
from satvib_experiment.scenario.folder import FOLDER, scenario_path
from satvib_experiment.scenario.memory import check_memory
from satvib_experiment.scenario.settings_file import (
    SCENARIO_PATHS,
    called,
    load_settings,
    resolve_path,
)

if TYPE_CHECKING:
    from satvib_control.parameters import ControllerParameters
    from satvib_control.supervision.parameters import SupervisorParameters
    from satvib_ident.parameters import IdentifierParameters
    from satvib_plant_sim.disturbance.base import Disturbance

# What the scenario gives to every node itself, so that no two of them can disagree.
_SHARED = ('sample_rate', 'lockstep', 'model_period')
_SET_BY = {
    'sample_rate': 'the rig sets it, acquisition.sample_rate',
    'lockstep': 'the way of running sets it',
    'model_period': 'set the model_period of the scenario, for all nodes at once',
    'strut': 'every strut gets its own',
    'struts': 'the rig sets it, struts.count',
    'strut_angles': 'the rig sets it, struts.first_angle',
    'strut_shapes': 'the rig sets it, struts.each',
}


@dataclass(frozen=True, kw_only=True)
class PhaseStep(Schema):
    """One phase and its start."""

    phase: str = param(description='what the struts do', choices=tuple(p.name for p in Phase))
    start: float = param(0.0, 'when it begins', unit='s', minimum=0.0)


@dataclass(frozen=True, kw_only=True)
class AnalysisSettings(Schema):
    """What the report looks at; what is left out is found from the phases and the disturbance."""

    uncontrolled: tuple[float, ...] = param(
        (), 'window with the disturbance and without control', unit='s'
    )
    controlled: tuple[float, ...] = param(
        (), 'window with the disturbance and settled control', unit='s'
    )
    frequencies: tuple[float, ...] = param((), 'tones to look at', unit='Hz', above=0.0)
    reference: tuple[float, ...] = param((), 'attenuation to compare with, per strut', unit='dB')
    reference_source: str = param('', 'where those figures come from')
    line_of_sight_from: float = param(
        2.0, 'frequency above which the tilt of the payload counts, in stretches of 3 periods of it at least',
        unit='Hz', above=0.0,
    )  # fmt: skip

    def check(self) -> None:
        """Check the windows."""
        for name in ('uncontrolled', 'controlled'):
            window = getattr(self, name)
            if window and not (len(window) == 2 and 0.0 <= window[0] < window[1]):
                raise SatvibError(f'{name}: a start and a later end are expected, not {window}')


@dataclass(frozen=True, kw_only=True)
class Scenario(Schema):
    """One experiment, complete: the same scenario and seed give the same samples, bit for bit."""

    name: str = param(description='name of the scenario; runs are filed under it')
    description: str = param('', 'what it shows')
    rig: str = param(description='name of a rig, or path of its YAML file')
    rig_overrides: dict[str, Any] = param(dict, 'changes to the rig by dotted key')
    seed: int = param(1, 'seed of everything random', minimum=0, maximum=2**63 - 1)
    duration: float = param(description='length of the experiment', unit='s', above=0.0)
    phases: tuple[PhaseStep, ...] = param(description='phases in order, the first at 0 s')
    disturbance: dict[str, Any] = param(dict, 'what shakes the lower plate; empty: nothing')
    failures: tuple[Failure, ...] = param((), 'what goes wrong, and when')
    command_timeout: float = param(
        0.05,
        'how long the board holds the voltage of a controller that says nothing, before it ramps '
        'to 0 V over that same time',
        unit='s',
        above=0.0,
    )
    identifier: dict[str, Any] = param(dict, 'parameters of the strut identifiers')
    controller: dict[str, Any] = param(
        dict,
        'parameters of the strut controllers; `file` names what `satvib tune --design notch` has '
        'written',
    )
    scheme: str = param(
        'decentralized',
        'a controller for each strut, or one for all of them',
        choices=('decentralized', 'centralized'),
    )
    centralized: dict[str, Any] = param(
        dict,
        'parameters of the centralized controller, over those of `controller`; `file` names what '
        '`satvib tune` has written',
    )
    supervisor: bool = param(
        False,
        'a supervisor listens to all struts, finds the one that makes the others loud, and stops it',
    )
    model_period: int = param(
        50, 'samples between hand-overs of the model; 0: only at phase changes', minimum=0
    )
    composition: str = param(
        'separate',
        'live run: a process for each node (separate), for each strut (strut), or for all (single)',
        choices=('separate', 'strut', 'single'),
    )
    analysis: AnalysisSettings = param(AnalysisSettings(), 'what the report looks at')

    def check(self) -> None:
        """Check the phases and what two keys would set twice."""
        check_folder_name(self.name)
        if not self.phases:
            raise SatvibError('phases: at least one is needed')
        for section in ('identifier', 'controller', 'centralized'):
            for key in _SET_BY:
                if key in getattr(self, section):
                    raise SatvibError(f'{section}.{key}: {_SET_BY[key]}')
        if self.supervisor and self.scheme == 'centralized':
            raise SatvibError(
                'supervisor: the centralized controller hears all struts itself; leave it out'
            )
        for name in ('uncontrolled', 'controlled'):
            window = getattr(self.analysis, name)
            if window and window[1] > self.duration:
                raise SatvibError(
                    f'analysis.{name}: ends at {window[1]} s, after the {self.duration} s'
                )

    def plan(self, rate: float) -> PhasePlan:
        """Give the phases by sample index.

        Args:
            rate: Hz, sample rate of the rig.

        Raises:
            SatvibError: phases out of order, or closer than a sample.
        """
        steps = [(Phase[step.phase], step.start) for step in self.phases]
        return PhasePlan.from_seconds(steps, self.duration, rate)

    def load_rig(self) -> AnyRig:
        """Give the rig with its overrides applied, its truth as fine as the disturbances need.

        Raises:
            SatvibError: no such rig, a value that it refuses, a disturbance that its truth cannot hold.
        """
        from satvib_plant_sim.disturbance.factory import make_disturbance
        from satvib_plant_sim.rig.fine_grid import fitted_grid

        later = [make_disturbance(f.disturbance) for f in self.failures if f.disturbance]
        rig = load_any_rig(self.rig, self.rig_overrides)
        return fitted_grid(rig, [self.make_disturbance(), *later])

    def make_disturbance(self) -> Disturbance:
        """Give the disturbance."""
        from satvib_plant_sim.disturbance.factory import make_disturbance

        return make_disturbance(self.disturbance or {'kind': 'none'})

    def identifier_parameters(self, rate: float, lockstep: bool = True) -> IdentifierParameters:
        """Give the parameters of every strut's identifier; `rate` in Hz."""
        from satvib_ident.parameters import IdentifierParameters

        return IdentifierParameters.from_mapping(
            self.identifier | self._shared(rate, lockstep), f'scenario {self.name}: identifier'
        )

    def controller_parameters(
        self, rate: float, lockstep: bool = True, strut_index: int = 0, struts: int | None = None
    ) -> ControllerParameters:
        """Give the parameters of a strut's controller, or of the centralized one.

        Args:
            rate: Hz.
            lockstep: no clock.
            strut_index: from 0; of no meaning in the centralized scheme, whose one controller has all struts.
            struts: how many there are; None: the rig is asked.
        """
        from satvib_control.parameters import ControllerParameters
        from satvib_plant_sim.rig.any_rig import strut_count

        if self.scheme == 'centralized':
            return centralized_parameters(
                self.name, self.load_rig(), self.controller, self.centralized,
                self._shared(rate, lockstep),
            )  # fmt: skip
        own = {'strut': strut_index, 'struts': struts or strut_count(self.load_rig())}
        own |= self._weights(rate)
        return ControllerParameters.from_mapping(
            self.controller | self._shared(rate, lockstep) | own,
            f'scenario {self.name}: controller',
        )

    def _weights(self, rate: float) -> dict[str, Any]:
        """What `narrowband_serve: payload` needs to know of the rig, unless the scenario gives it."""
        settings = self.controller
        if settings.get('narrowband_serve') != 'payload' or 'narrowband_weights' in settings:
            return {}
        from satvib_plant_sim.responses.images import weight_table
        from satvib_plant_sim.rig.rig import Rig

        rig = self.load_rig()
        if not isinstance(rig, Rig):
            raise SatvibError(
                f'scenario {self.name}: controller.narrowband_serve: {rig.name} is a rig of identified models; '
                'nothing is known of it between the samples'
            )
        return {'narrowband_weights': weight_table(rig, 1.0, 0.45 * rate)}

    def supervisor_parameters(
        self, rate: float, lockstep: bool = True, struts: int | None = None
    ) -> SupervisorParameters:
        """Give the parameters of the supervisor; `rate` in Hz, `struts` None: the rig is asked."""
        from satvib_control.supervision.parameters import SupervisorParameters

        controller = self.controller_parameters(rate, lockstep, struts=struts)
        return SupervisorParameters(
            sample_rate=controller.sample_rate,
            lockstep=lockstep,
            struts=controller.struts,
            voltage_limit=controller.voltage_limit,
            watch_floor=controller.watch_floor,
        )

    def _shared(self, rate: float, lockstep: bool) -> dict[str, Any]:
        values = (float(rate), lockstep, self.model_period)
        return dict(zip(_SHARED, values, strict=True))


def load_scenario(name_or_path: str | Path, overrides: Sequence[str] = ()) -> Scenario:
    """Load a scenario and check all of it: its keys, rig, disturbance, identifier and controller.

    Args:
        name_or_path: a name of `scenario_names()`, or the path of a YAML file.
        overrides: changes as 'key=value' with dots for nested keys; 'rig.payload.mass=12' changes the rig.
            A relative path in them refers to the current folder, one in the file to the folder of the file.

    Raises:
        SatvibError: no such scenario, or anything in it that is wrong.
    """
    path = scenario_path(name_or_path)
    data = load_settings(path, overrides, SCENARIO_PATHS)
    take_gains(data, path)
    data.setdefault('name', path.stem)
    where = called('scenario', path, FOLDER)
    scenario = Scenario.from_mapping(data, where)
    rig = resolve_path(scenario.rig, path.parent)
    scenario = scenario.replace(rig=rig)
    check_scenario(scenario, where)
    return scenario


def check_scenario(scenario: Scenario, where: str) -> None:
    """Build every part of a scenario once, so that what is wrong shows before anything starts.

    Raises:
        SatvibError: the first thing that is wrong, `where` named; what is wrong in the file of a rig leads with it.
    """
    try:
        rig = scenario.load_rig()
        rate = rig.acquisition.sample_rate
        check_memory(scenario.plan(rate).end, rig)
        check_failures(scenario.failures, rig, scenario.duration)
        scenario.identifier_parameters(rate)
        scenario.controller_parameters(rate)
        reference = len(scenario.analysis.reference)
        if reference not in {0, strut_count(rig)}:
            raise SatvibError(
                f'analysis.reference: {reference} figures for the {strut_count(rig)} struts of {rig.name}'
            )
    except SatvibError as error:
        if str(error).startswith((f'{scenario.rig}: ', f'{where}: ')):
            raise
        raise SatvibError(f'{where}: {error}') from None
