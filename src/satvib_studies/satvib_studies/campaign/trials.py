# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""From a campaign to the scenario of every trial, and to the command that runs a trial as a live graph."""

from __future__ import annotations

import dataclasses
import json
import shlex
from collections.abc import Iterable
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest
from satvib_common.schema import LARGEST_INTEGER
from satvib_common.settings_text import RIG_CHANGES, change_setting, setting_text
from satvib_experiment.scenario.memory import STEP_TIME, check_needs
from satvib_experiment.scenario.scenario import Scenario, check_scenario, load_scenario

from satvib_studies.campaign.drawing.sampling import draw
from satvib_studies.campaign.settings import Campaign

_NAMES = tuple(field.name for field in dataclasses.fields(Scenario))
_FIELD = {'rig': RIG_CHANGES}
_ROW = 500  # bytes of a trial in the table, at least


@dataclass(frozen=True)
class TrialPlan:
    """Every trial of a campaign.

    Attributes:
        campaign: what was asked for.
        base: the scenario with the shared changes, and nothing drawn.
        values: by key: the value of every trial.
        seeds: seed of every trial.
    """

    campaign: Campaign
    base: Scenario
    values: dict[str, list[Any]]
    seeds: list[int]

    def settings(self, trial: int) -> list[str]:
        """Give what `--set` needs for one trial, shared changes included."""
        texts = [setting_text(k, v) for k, v in self.campaign.set.items()]
        texts += [setting_text(k, v[trial]) for k, v in self.values.items()]
        if 'seed' not in self.values:
            texts = [s for s in texts if not s.startswith('seed=')]
            texts.append(f'seed={self.seeds[trial]}')
        return texts

    def scenario(self, trial: int) -> Scenario:
        """Give one trial's scenario; it is checked as it is built, its rig when that is loaded.

        Raises:
            SatvibError: values that make no scenario.
        """
        values = {key: value[trial] for key, value in self.values.items()}
        return self._scenario(values | {'seed': self.seeds[trial]})

    def _scenario(self, values: dict[str, Any]) -> Scenario:
        heads = {_FIELD.get(head, head) for head in (key.split('.')[0] for key in values)}
        data = {name: deepcopy(getattr(self.base, name)) for name in heads & set(_NAMES)}
        for key, value in values.items():
            change_setting(data, key, value, f'{key}={value}')
        unknown = set(data) - set(_NAMES)
        if unknown:
            name = min(unknown)
            raise SatvibError(f'{name}: no such key; {nearest(name, sorted(_NAMES))}')
        return self.base.replace(**data)

    def command(self, trial: int, live: bool = True) -> str:
        """Give the line that runs one trial again, as a live graph or in one process."""
        words = ['./satvib', 'run' if live else 'simulate', self.campaign.scenario]
        for text in self.settings(trial):
            words += ['--set', text]
        return shlex.join(words)

    def part(self, trials: Iterable[int]) -> TrialPlan:
        """Give a plan of some of the trials, which is all that a worker needs."""
        chosen = list(trials)
        return TrialPlan(
            self.campaign,
            self.base,
            {key: [values[i] for i in chosen] for key, values in self.values.items()},
            [self.seeds[i] for i in chosen],
        )

    def check(self) -> None:
        """Build the scenario at both ends of every parameter, so that what is wrong shows before anything runs.

        Raises:
            SatvibError: the parameter and what is wrong with it.
        """
        for key, values in self.values.items():
            for value in _ends(values):
                where = f'campaign {self.campaign.name}: parameters: {key} = {value}'
                try:
                    scenario = self._scenario({key: value})
                except SatvibError as error:
                    raise SatvibError(f'{where}: {error}') from None
                check_scenario(scenario, where)


def _ends(values: list[Any]) -> list[Any]:
    """The least and the largest of numbers, or each of other values once."""
    if all(isinstance(v, int | float) and not isinstance(v, bool) for v in values):
        return sorted({min(values), max(values)})
    unique = {json.dumps(v): v for v in values}
    return [unique[key] for key in sorted(unique)]


def plan_trials(campaign: Campaign) -> TrialPlan:
    """Draw every trial of a campaign, and check what can be checked before running.

    Raises:
        SatvibError: no such scenario, a key that does not exist, values that it refuses.
    """
    where = f'campaign {campaign.name}'
    try:
        base = load_scenario(
            campaign.scenario, [setting_text(k, v) for k, v in campaign.set.items()]
        )
    except SatvibError as error:
        raise SatvibError(f'{where}: {error}') from None
    samples = base.plan(base.load_rig().acquisition.sample_rate).end
    check_needs(
        f'{where}: trials: {campaign.trials} trials of {samples} samples',
        campaign.trials * _ROW,
        campaign.trials * samples * STEP_TIME,
    )
    plan = plan_from(campaign, base)
    plan.check()
    return plan


def plan_from(campaign: Campaign, base: Scenario) -> TrialPlan:
    """Draw every trial of a campaign over a scenario that is checked already.

    Raises:
        SatvibError: seeds that cannot be held.
    """
    values = draw(campaign)
    if 'seed' in values:
        seeds = [int(v) for v in values['seed']]
    elif campaign.own_seed:
        if base.seed + campaign.trials - 1 > LARGEST_INTEGER:
            raise SatvibError(
                f'campaign {campaign.name}: seed: {base.seed} plus the number of the trial is beyond '
                '2^63 - 1'
            )
        seeds = [base.seed + i for i in range(campaign.trials)]
    else:
        seeds = [base.seed] * campaign.trials
    return TrialPlan(campaign, base, values, seeds)
