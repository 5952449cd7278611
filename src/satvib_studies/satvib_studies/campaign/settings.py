# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A campaign: a scenario, what varies in it, how many trials, and how the trials are spread.

    name: payload_spread
    scenario: paper_3dof
    set: {controller.law: velocity_feedback}      # the same for all trials
    trials: 2000
    sampling: sobol
    parameters:
      rig.payload.mass: {kind: uniform, low: 7.0, high: 11.0}
      disturbance.frequency: {kind: choice, values: [8.0, 10.0, 12.0]}

Keys are those of `./satvib run --set`. Every trial has a seed of its own: the scenario's plus the number of the trial,
unless `seed` is a parameter itself.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.files.folder_name import check_folder_name
from satvib_common.schema import Schema, param
from satvib_common.settings_text import is_key
from satvib_experiment.scenario.settings_file import (
    SCENARIO_PATHS,
    called,
    load_settings,
    names_in,
    resolve_path,
    resolve_paths,
    settings_path,
)

from satvib_studies.campaign.drawing.distribution import Distribution

FOLDER = Path(__file__).parents[1] / 'campaigns'
_PATHS = ('scenario', *(f'set.{key}' for key in SCENARIO_PATHS))
SAMPLINGS = ('latin_hypercube', 'sobol')
# what makes trials incomparable or belongs to the campaign itself
_FIXED = ('name', 'description', 'rig', 'rig_overrides', 'phases', 'duration', 'analysis')


@dataclass(frozen=True, kw_only=True)
class Campaign(Schema):
    """Trials of one scenario with parameters drawn from distributions."""

    name: str = param(description='name of the campaign; its folder is called after it')
    description: str = param('', 'what it asks')
    scenario: str = param(description='name of a scenario, or path of its YAML file')
    set: dict[str, Any] = param(dict, 'changes to the scenario that all trials share, by key')
    trials: int = param(description='how many', minimum=1, maximum=10_000_000)
    sampling: str = param('latin_hypercube', 'how they are spread', choices=SAMPLINGS)
    seed: int = param(1, 'of the sampling', minimum=0, maximum=2**63 - 1)
    own_seed: bool = param(True, 'every trial has noise and biases of its own')
    chunk: int = param(
        0, 'trials that run as one batch and are kept as one part; 0: by the number of trials',
        minimum=0, maximum=100_000,
    )  # fmt: skip
    judge: str = param('attenuation_true_rms', 'figure by which trials are worse the larger it is')
    parameters: dict[str, Any] = param(description='distribution by key, as for --set')

    def check(self) -> None:
        """Check names, and every distribution."""
        check_folder_name(self.name)
        if not self.parameters:
            raise SatvibError('parameters: at least one is needed')
        for key in (*self.parameters, *self.set):
            if not is_key(key):
                raise SatvibError(f'{key}: a key with dots for nested keys is expected')
        for key in self.parameters:
            if key.split('.')[0] in _FIXED and not key.startswith('rig.'):
                raise SatvibError(f'{key}: is shared by all trials, or they cannot be compared')
        for key in self.parameters:
            if key in self.set:
                raise SatvibError(f'{key}: is in set and in parameters')
        self.distributions()

    def distributions(self) -> dict[str, Distribution]:
        """Distribution by key, in the order of the file."""
        return {
            key: Distribution.from_mapping(value, f'parameters: {key}')
            for key, value in self.parameters.items()
        }

    @property
    def size(self) -> int:
        """Trials of a part; the same whatever runs them."""
        return self.chunk or min(max(self.trials // 8, 25), 500)

    @property
    def chunks(self) -> int:
        """Number of parts."""
        return -(-self.trials // self.size)

    def chunk_of(self, index: int) -> range:
        """Numbers of the trials of one part."""
        return range(index * self.size, min((index + 1) * self.size, self.trials))

    def digest(self, scenario: dict[str, Any]) -> str:
        """Fingerprint of everything that decides the trials; `scenario` as plain data, overrides applied."""
        campaign = {
            k: v for k, v in self.to_mapping().items() if k not in {'description', 'name', 'judge'}
        }
        text = json.dumps([campaign, scenario], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def campaign_names() -> list[str]:
    """Names of the campaigns that come with the package."""
    return names_in(FOLDER)


def load_campaign(name_or_path: str | Path, overrides: Sequence[str] = ()) -> Campaign:
    """Load a campaign; whether its keys exist in the scenario is checked by `plan_trials`.

    Args:
        name_or_path: a name of `campaign_names()`, or the path of a YAML file.
        overrides: changes to the campaign as 'key=value', for instance trials=100; a relative path in them refers
            to the current folder.

    Raises:
        SatvibError: no such campaign, or anything in it that is wrong.
    """
    path = settings_path('campaign', name_or_path, FOLDER)
    data = load_settings(path, overrides, _PATHS)
    if 'set' in data:
        data['set'] = resolve_paths('set', data['set'], _PATHS, path.parent)
    data.setdefault('name', path.stem)
    campaign = Campaign.from_mapping(data, called('campaign', path, FOLDER))
    return campaign.replace(scenario=resolve_path(campaign.scenario, path.parent))
