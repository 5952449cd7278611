# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What happened in an experiment, as arrays by sample and strut, from the offline twin or from a bag.

A recording has one group of arrays per topic, named after it (`identified_model` is `model`, `controller_state` is
`state`), and one array per field of its message, named as in the message: `recording.get('acceleration', 'upper')` is
(samples, struts), `recording.get('model', 'a')` is (samples, struts, n). `present` marks where a message was.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_plant_sim.rig.any_rig import AnyRig

from satvib_experiment.recording.topics import TOPICS
from satvib_experiment.scenario.scenario import Scenario

Group = dict[str, NDArray[Any]]

FORMAT = 'satvib recording 1'

# Fields that describe the machine, not the experiment.
MACHINE_FIELDS = {
    ('state', 'compute_time'), ('state', 'time_step'), ('state', 'applied'), ('state', 'applied_state'),
    ('acceleration', 'applied'), ('acceleration', 'applied_state'), ('acceleration', 'pace'),
    ('model', 'bias_lower'),
}  # fmt: skip


@dataclass
class Recording:
    """One run.

    Attributes:
        struts: their names, in order.
        sample_period: s.
        plan: phases by sample.
        sequence: (samples,), consecutive.
        stamp: (samples,) ns, instants of sampling.
        groups: arrays by group and field; the first two axes are (samples, struts).
        scenario, rig: what was run, None when the bag does not say.
        realtime: whether the run followed the wall clock.
        seed: of everything random.
        source: where it comes from, for people.
        counts: what was lost, late or repeated.
        name: of the scenario, also where the scenario itself is not known; '' when nothing says it.
        notes: sentences about the recording itself, for instance what is missing in it.
        is_cut: its file was cut short: it may end before its windows.
    """

    struts: tuple[str, ...]
    sample_period: float
    plan: PhasePlan
    sequence: Integers
    stamp: Integers
    groups: dict[str, Group]
    scenario: Scenario | None = None
    rig: AnyRig | None = None
    realtime: bool = False
    seed: int = 0
    source: str = 'simulation'
    counts: dict[str, int] = field(default_factory=dict)
    name: str = ''
    notes: list[str] = field(default_factory=list)
    is_cut: bool = False

    def __post_init__(self) -> None:
        """Take the name of the scenario where it is known."""
        if self.scenario is not None:
            self.name = self.scenario.name

    @property
    def law(self) -> str:
        """Name of the law that acts in CONTROL; '' where nothing says it."""
        if self.scenario is None:
            return ''
        central = self.scenario.scheme == 'centralized'
        return 'centralized' if central else str(self.scenario.controller.get('law', ''))

    @property
    def title(self) -> str:
        """What a figure of this run says of it: name, rig, law and seed, as far as they are known."""
        return run_title(self, [self.law] if self.law else [])

    def has(self, group: str, name: str | None = None) -> bool:
        """Whether a group, or a field of it, is there."""
        return group in self.groups and (name is None or name in self.groups[group])

    def get(self, group: str, name: str) -> NDArray[Any]:
        """Give one field (samples, struts, ...).

        Raises:
            SatvibError: the run was recorded without it.
        """
        if not self.has(group, name):
            topic = TOPICS[group][0] if group in TOPICS else group
            raise SatvibError(f'{self.source}: no {name} of topic {topic} was recorded')
        return self.groups[group][name]

    @property
    def time(self) -> Array:
        """Time of each sample since sample 0 (samples,), s."""
        return np.asarray(self.sequence * self.sample_period)

    @property
    def phase(self) -> Integers:
        """Phase of each sample (samples,)."""
        return np.array([self.plan.at(int(k)) for k in self.sequence])

    @property
    def fine_period(self) -> float:
        """Spacing of the truth's fine samples, s."""
        return self.sample_period / self.get('truth', 'upper').shape[2]

    def window(self, start: float, stop: float) -> slice:
        """Index range of the samples in [start, stop) s."""
        rate = 1.0 / self.sample_period
        first = int(self.sequence[0])
        return slice(max(round(start * rate) - first, 0), max(round(stop * rate) - first, 0))

    def phases(self) -> list[tuple[Phase, float, float]]:
        """Phases with start and end in s, as far as they were recorded."""
        last = (int(self.sequence[-1]) + 1) * self.sample_period
        starts = [k * self.sample_period for k in self.plan.first]
        ends = [*starts[1:], max(last, starts[-1])]
        return [
            (phase, start, min(end, last))
            for phase, start, end in zip(self.plan.phases, starts, ends, strict=True)
            if start < last
        ]

    def lost(self) -> dict[str, int]:
        """Messages per group that should be there and are not.

        Models come on some samples only, and in real time the states of the controllers do.
        """
        sparse = {'model', 'state'} if self.realtime else {'model'}
        return {
            group: int(np.size(fields['present']) - np.count_nonzero(fields['present']))
            for group, fields in self.groups.items()
            if group not in sparse
        }

    def save(self, path: Path) -> None:
        """Write one compressed .npz file.

        Raises:
            SatvibError: it exists already, or cannot be written.
        """
        about = {
            'format': FORMAT,
            'struts': self.struts,
            'sample_period': self.sample_period,
            'phases': [phase.name for phase in self.plan.phases],
            'first': self.plan.first,
            'end': self.plan.end,
            'scenario': self.scenario.to_mapping() if self.scenario else None,
            'rig': self.rig.to_mapping() if self.rig else None,
            'realtime': self.realtime,
            'seed': self.seed,
            'source': self.source,
            'counts': self.counts,
            'name': self.name,
            'notes': self.notes,
        }
        arrays = {f'{g}/{n}': a for g, group in self.groups.items() for n, a in group.items()}
        try:
            with path.open('xb') as sink:
                np.savez_compressed(
                    sink, about=np.array(json.dumps(about)), sequence=self.sequence,
                    stamp=self.stamp, **arrays,  # type: ignore[arg-type]
                )  # fmt: skip
        except FileExistsError:
            raise SatvibError(f'{path}: exists already, not overwritten') from None
        except OSError as error:
            raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None


def differences(first: Recording, second: Recording) -> list[str]:
    """Where two recordings differ in a single bit, one line per field; empty when they are the same.

    Stamps and what describes the machine are left out; models are compared on the samples that both have.
    """
    if first.sequence.shape != second.sequence.shape:
        return [f'{len(first.sequence)} samples against {len(second.sequence)}']
    lines = []
    for group in sorted(set(first.groups) | set(second.groups)):
        if not (first.has(group) and second.has(group)):
            lines.append(f'{group}: only one of them has it')
            continue
        present = [r.get(group, 'present') for r in (first, second)]
        if group != 'model' and not np.array_equal(present[0], present[1]):
            lines.append(f'{group}: messages missing in one of them')
        both = present[0] & present[1]
        names = set(first.groups[group]) & set(second.groups[group]) - {'present'}
        for name in sorted(names):
            if (group, name) not in MACHINE_FIELDS:
                lines += _difference(f'{group}.{name}', group, name, first, second, both)
    return lines


def _difference(
    label: str, group: str, name: str, first: Recording, second: Recording, both: Mask
) -> list[str]:
    a, b = first.get(group, name), second.get(group, name)
    if a.shape[2:] != b.shape[2:]:
        return [f'{label}: shape {a.shape} against {b.shape}']
    a, b = a[both], b[both]
    same = a == b
    if a.dtype.kind == 'f' and b.dtype.kind == 'f':
        same = same & (np.signbit(a) == np.signbit(b)) | np.isnan(a) & np.isnan(b)
    if np.all(same):
        return []
    where = np.argwhere(both)[np.argwhere(~same)[0][0]]
    return [
        (
            f'{label}: {np.count_nonzero(~same)} of {same.size} differ, first at sample '
            f'{int(first.sequence[where[0]])} of {first.struts[where[1]]}'
        )
    ]


def run_title(recording: Recording, laws: Sequence[str], name: str = '') -> str:
    """Name a run, its rig, laws and seed in one line.

    Args:
        recording: the run.
        laws: that acted.
        name: in the place of the run's own.
    """
    scenario, rig = recording.scenario, recording.rig
    changed = ' with changes' if scenario is not None and scenario.rig_overrides else ''
    parts = [name or recording.name or recording.source]
    parts += [f'rig {rig.name}{changed}'] if rig is not None else []
    parts += [', '.join(law.replace('_', ' ') for law in laws)] if laws else []
    parts += [f'seed {recording.seed}'] if scenario is not None else []
    return ' · '.join(parts)
