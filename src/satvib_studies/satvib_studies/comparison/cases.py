# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is compared: schemes and cases, as scenarios.

Seed i of every case and scheme has the same rig, drawn within the tolerances of its parts, and the same noise:
stiffness +-5 % and force constant +-10 % of each strut, damping +-30 %.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest
from satvib_common.files.yaml_file import load_yaml
from satvib_common.schema import Schema, param, shown
from satvib_common.settings_text import change_settings
from satvib_experiment.scenario.centralized_scheme import take_gains
from satvib_experiment.scenario.memory import STEP_TIME, check_needs
from satvib_experiment.scenario.scenario import Scenario, check_scenario
from satvib_plant_sim.plant.failures import Failure
from satvib_plant_sim.rig.random_rig import random_parts
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.sweep.sweep import merged

FILE = Path(__file__).parent / 'comparison.yaml'
# the comparisons that come with the package, by name
NAMED = {'schemes': 'comparison.yaml', 'hexapod': 'hexapod.yaml'}
STREAM = 73
_TRIAL = 30e3  # bytes of a trial in a batch, at least
OPEN = 'open'  # what all schemes are measured against: 0 V


@dataclass(frozen=True, kw_only=True)
class Scheme(Schema):
    """One way to control."""

    title: str = param(description='in words')
    keys: dict[str, Any] = param(dict, 'keys of a scenario')


@dataclass(frozen=True, kw_only=True)
class Case(Schema):
    """One thing that can happen."""

    title: str = param(description='in words')
    keys: dict[str, Any] = param(dict, 'keys of a scenario')
    failures: tuple[Any, ...] = param((), 'what goes wrong at the event, without a time')
    centralized_failures: tuple[Any, ...] = param((), 'the same for the centralized scheme')


@dataclass(frozen=True, kw_only=True)
class Comparison(Schema):
    """Schemes in cases."""

    name: str = param('schemes', 'name')
    base: dict[str, Any] = param(description='keys of a scenario that all share')
    event: float = param(description='when the failures happen', unit='s', minimum=0.0)
    windows: dict[str, Any] = param(description='by name: start and end, s')
    seeds: int = param(8, 'rigs and noises', minimum=1, maximum=1000)
    seed: int = param(1, 'the first seed', minimum=0)
    schemes: dict[str, Any] = param(description='by name: see Scheme')
    cases: dict[str, Any] = param(description='by name: see Case')

    def check(self) -> None:
        """Check schemes, cases and windows."""
        self.scheme_list()
        self.case_list()
        for name, window in self.windows.items():
            if not (
                isinstance(window, list | tuple)
                and len(window) == 2
                and all(type(t) in {int, float} for t in window)
                and window[0] < window[1]
            ):
                raise SatvibError(f'windows.{name}: a start and a later end are expected')

    def scheme_list(self) -> dict[str, Scheme]:
        """Give the schemes by name."""
        return {k: Scheme.from_mapping(v, f'schemes.{k}') for k, v in self.schemes.items()}

    def case_list(self) -> dict[str, Case]:
        """Give the cases by name."""
        return {k: Case.from_mapping(v, f'cases.{k}') for k, v in self.cases.items()}

    def scenario(self, scheme: str, case: str, seed: int) -> Scenario:
        """Give the scenario of a scheme in a case; `scheme` may be 'open'.

        Raises:
            SatvibError: it is none.
        """
        there = self.case_list()[case]
        data = merged({'name': f'{scheme}-{case}', **self.base}, there.keys)
        if 'disturbance' in there.keys:
            data['disturbance'] = there.keys['disturbance']  # another one, not a change of the old
        if scheme != OPEN:
            data = merged(data, self.scheme_list()[scheme].keys)
        central = data.get('scheme') == 'centralized'
        listed = there.centralized_failures if central else ()
        failures = [
            self._failure(f, f'comparison {self.name}: cases.{case}: failures[{i}]')
            for i, f in enumerate(listed or there.failures)
        ]
        data |= {'seed': seed, 'failures': [f.to_mapping() for f in failures]}
        where = f'comparison {self.name}: {scheme}, {case}'
        scenario = Scenario.from_mapping(data, where)
        check_scenario(scenario, where)
        return scenario

    def _failure(self, settings: Any, where: str) -> Failure:
        """Give a failure at the event."""
        if not isinstance(settings, Mapping):
            raise SatvibError(f'{where}: a mapping of keys is expected, not {shown(settings)}')
        return Failure.from_mapping({**settings, 'time': self.event}, where)


def drawn_rig(rig: Rig, seed: int) -> Rig:
    """Give the rig that a seed has, within the tolerances of its parts."""
    return random_parts(rig, np.random.default_rng([seed, STREAM]))


def replayable(comparison: Comparison, scheme: str, case: str, seed: int) -> Scenario:
    """Give a cell as a scenario that holds its drawn rig, to be run or simulated by itself, live too."""
    scenario = comparison.scenario(scheme, case, seed)
    rig = scenario.load_rig()
    if not isinstance(rig, Rig):
        raise SatvibError(f'comparison {comparison.name}: {rig.name} has no struts to draw')
    return scenario.replace(rig_overrides={**scenario.rig_overrides, **drawn_changes(rig, seed)})


def drawn_changes(rig: Rig, seed: int) -> dict[str, Any]:
    """Give the rig of a seed, `drawn_rig`, as changes of a scenario's rig."""
    drawn = drawn_rig(rig, seed)
    return {
        'struts.stiffness_scale': list(drawn.struts.stiffness_scale),
        'struts.damping': drawn.struts.damping,
        'coil.force_scale': list(drawn.coil.force_scale),
    }


def comparison_path(name_or_path: str | Path) -> Path:
    """Give the file of a comparison of the package, or a path as it is.

    Raises:
        SatvibError: no such name.
    """
    text = str(name_or_path)
    if text.endswith(('.yaml', '.yml')) or '/' in text:
        return Path(text)
    if text not in NAMED:
        raise SatvibError(f'comparison {text!r}: no such comparison; {nearest(text, list(NAMED))}')
    return Path(__file__).parent / NAMED[text]


def load_comparison(
    name_or_path: str | Path | None = None, overrides: Sequence[str] = ()
) -> Comparison:
    """Load a comparison: that of the package, another one by its name, or one of a file.

    What `file` names in the keys of a scheme is beside that file.

    Raises:
        SatvibError: a wrong key, or a cell that is no scenario.
    """
    file = FILE if name_or_path is None else comparison_path(name_or_path)
    data = load_yaml(file)
    if not isinstance(data, dict):
        raise SatvibError(f'{file}: a mapping of keys is expected')
    change_settings(data, overrides)
    for scheme in (data.get('schemes') or {}).values():
        if isinstance(scheme, dict) and isinstance(scheme.get('keys'), dict):
            take_gains(scheme['keys'], file)
    loaded = Comparison.from_mapping(data, str(file))
    samples = 0
    for scheme in loaded.schemes:
        for case in loaded.cases:
            scenario = loaded.scenario(scheme, case, loaded.seed)
            samples = scenario.plan(scenario.load_rig().acquisition.sample_rate).end
    trials, runs = len(loaded.cases) * loaded.seeds, len(loaded.schemes) + 1
    check_needs(
        f'{file}: seeds: {runs} times {trials} trials of {samples} samples',
        trials * (samples * runs * 16.0 + _TRIAL),
        trials * samples * runs * STEP_TIME,
    )
    return loaded
