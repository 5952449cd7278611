# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is judged: laws on rigs, as scenarios of a measured base motion and of a wheel that runs up.

The first seed has the rig as it is. The others have rigs drawn within the tolerances of their parts, as a comparison
draws them. Every law has the same rigs, base motions and noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest
from satvib_common.files.yaml_file import load_yaml
from satvib_common.schema import Schema, param
from satvib_common.settings_text import change_settings
from satvib_experiment.frf.measurement import MeasurementSettings, base_scenario
from satvib_experiment.frf.modes import named_motions
from satvib_experiment.scenario.centralized_scheme import take_gains
from satvib_experiment.scenario.scenario import Scenario, check_scenario, load_scenario
from satvib_ident.frequency.settings import FrfSettings
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.comparison.cases import drawn_changes
from satvib_studies.sweep.sweep import merged

FILE = Path(__file__).parent / 'isolation.yaml'
OPEN = 'open'  # 0 V
KINDS = ('fixed', 'adaptive')


@dataclass(frozen=True, kw_only=True)
class LawCase(Schema):
    """One law."""

    title: str = param(description='in words')
    kind: str = param('fixed', 'fixed: a fixed filter, or gains that stay; adaptive', choices=KINDS)
    keys: dict[str, Any] = param(dict, 'keys of a scenario')


@dataclass(frozen=True, kw_only=True)
class RigCase(Schema):
    """One rig, by its scenarios."""

    scenario: str = param(description='whose rig and identification are measured')
    wheel: str = param(description='in which a wheel runs up')
    keys: dict[str, Any] = param(dict, 'keys of both')
    scenario_keys: dict[str, Any] = param(dict, 'keys of the first alone')
    wheel_keys: dict[str, Any] = param(dict, 'keys of the second alone')
    laws: dict[str, Any] = param(dict, 'by law: keys that it has on this rig')


@dataclass(frozen=True, kw_only=True)
class Isolation(Schema):
    """Laws on rigs."""

    name: str = param('isolation', 'name')
    seeds: int = param(8, 'rigs, base motions and noises', minimum=1, maximum=1000)
    seed: int = param(1, 'the first seed', minimum=0)
    measurement: MeasurementSettings = param(
        MeasurementSettings(signal='random'), 'how the base moves'
    )
    frf: FrfSettings = param(FrfSettings(), 'of the estimates')
    roll_off: tuple[float, ...] = param((25.0, 80.0), 'band of the roll-off', unit='Hz')
    laws: dict[str, Any] = param(description='by name: see LawCase')
    rigs: dict[str, Any] = param(description='by name: see RigCase')

    def check(self) -> None:
        """Check laws, rigs and the band."""
        known = self.law_list()
        for name, rig in self.rig_list().items():
            for law in rig.laws:
                if law not in known:
                    raise SatvibError(
                        f'rigs.{name}.laws: no law {law!r}; {nearest(law, list(known))}'
                    )
        if len(self.roll_off) != 2 or not 0.0 < self.roll_off[0] < self.roll_off[1]:
            raise SatvibError('roll_off: a frequency and a higher one are expected, Hz')

    def law_list(self) -> dict[str, LawCase]:
        """Give the laws by name."""
        return {k: LawCase.from_mapping(v, f'laws.{k}') for k, v in self.laws.items()}

    def rig_list(self) -> dict[str, RigCase]:
        """Give the rigs by name."""
        return {k: RigCase.from_mapping(v, f'rigs.{k}') for k, v in self.rigs.items()}

    def measured(self, rig: str, law: str) -> list[Scenario]:
        """Give the experiments that move the base, one for each seed; `law` may be 'open'.

        Raises:
            SatvibError: they are none.
        """
        case = self.rig_list()[rig]
        loops = ('open',) if law == OPEN else ('closed',)
        return [
            base_scenario(s, self.measurement, loops=loops)
            for s in self._scenarios(rig, law, case.scenario, case.scenario_keys)
        ]

    def wheels(self, rig: str, law: str) -> list[Scenario]:
        """Give the scenarios in which the wheel runs up, one for each seed; `law` may be 'open'.

        Raises:
            SatvibError: they are none.
        """
        case = self.rig_list()[rig]
        return self._scenarios(rig, law, case.wheel, case.wheel_keys)

    def _scenarios(self, rig: str, law: str, name: str, own: dict[str, Any]) -> list[Scenario]:
        case, data = self.rig_list()[rig], load_scenario(name).to_mapping()
        keys = {'controller': {'law': 'off'}} if law == OPEN else self.law_list()[law].keys
        for more in (case.keys, own, keys, case.laws.get(law, {})):
            data = merged(data, more)
        found = []
        for seed in range(self.seed, self.seed + self.seeds):
            where = f'{self.name}: {rig}, {law}'
            made = Scenario.from_mapping({**data, 'name': f'{law}-{name}', 'seed': seed}, where)
            loaded = made.load_rig()
            if not isinstance(loaded, Rig):
                raise SatvibError(f'{where}: {loaded.name} has no geometry')
            if len(named_motions(loaded)[0]) < 2:
                raise SatvibError(f'{where}: {loaded.name} has one strut, and nothing to tilt')
            if seed != self.seed:
                changes = drawn_changes(loaded, seed)
                made = made.replace(rig_overrides={**made.rig_overrides, **changes})
            check_scenario(made, where)
            found.append(made)
        return found


def load_isolation(path: Path | None = None, overrides: Sequence[str] = ()) -> Isolation:
    """Load what the package judges, or a file; what `file` names in the keys of a law is beside it.

    Raises:
        SatvibError: a wrong key.
    """
    file = path or FILE
    data = load_yaml(file)
    if not isinstance(data, dict):
        raise SatvibError(f'{file}: a mapping of keys is expected')
    change_settings(data, overrides)
    for rig in (data.get('rigs') or {}).values():
        for keys in (rig.get('laws') or {}).values() if isinstance(rig, dict) else ():
            if isinstance(keys, dict):
                take_gains(keys, file)
    return Isolation.from_mapping(data, str(file))
