# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Reading a bag into a `Recording`: no ROS needed, the message definitions are the bag's own.

Any rosbag2 bag will do that holds accelerations of struts, made by satvib's recorder or by `ros2 bag record`. What is
missing in it is said, and the rest is read. The recorder also leaves the scenario and the rig in the bag's custom
data, which `custom_data` makes.
"""

from collections import Counter, defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from satvib_common.errors import SatvibError, printable
from satvib_common.files.yaml_file import load_yaml, parse_yaml
from satvib_plant_sim.rig.any_rig import AnyRig, rig_from_mapping, strut_count

from satvib_experiment.recording.bag.definitions import DIAGNOSTICS, PACKAGE, Messages
from satvib_experiment.recording.bag.facts import Facts, facts_of
from satvib_experiment.recording.bag.files import BagContent, find_bag, read_bag
from satvib_experiment.recording.bag.groups import MOST_PER_MESSAGE, group_arrays
from satvib_experiment.recording.recording import Group, Recording
from satvib_experiment.recording.topics import TOPICS
from satvib_experiment.recording.unpack import hold, truth_samples
from satvib_experiment.scenario.scenario import Scenario

_KINDS = frozenset(
    {DIAGNOSTICS, f'{PACKAGE}/Schedule', *(f'{PACKAGE}/{kind}' for _, kind in TOPICS.values())}
)
_BETWEEN = 1000  # samples that may be missing in any recording
_LAST = 2**62

ByStrut = dict[str, list[Any]]


def custom_data(scenario: Scenario, rig: AnyRig, realtime: bool) -> dict[str, str]:
    """Give what the recorder stores in the bag beside the messages, as texts."""
    return {
        'satvib_scenario': yaml.safe_dump(scenario.to_mapping(), sort_keys=False),
        'satvib_rig': yaml.safe_dump(rig.to_mapping(), sort_keys=False),
        'satvib_realtime': 'true' if realtime else 'false',
    }


def read_recording(path: Path, recover: bool = False) -> Recording:
    """Read a bag.

    Args:
        path: the bag's folder, its file, or the folder of the run that holds it.
        recover: read what can be read of a damaged bag; a cut one is read in any case.

    Raises:
        SatvibError: not a bag, a bag without satvib's topics, a damaged bag.
    """
    bag = find_bag(path)
    try:
        content = read_bag(bag, _KINDS, recover)
        return _Reader(bag, content, recover).recording()
    except SatvibError:
        raise
    except OSError as error:
        raise SatvibError(f'{bag}: cannot be read: {error.strerror}') from None
    except Exception as error:  # a parser that meets damaged bytes raises anything  # noqa: BLE001
        raise SatvibError(f'{bag}: damaged or cut short: {_one_line(error)}') from None


def _one_line(error: BaseException) -> str:
    return printable(' '.join(str(error).split()), 300) or type(error).__name__


@dataclass
class _Reader:
    """One bag on its way into a recording."""

    bag: Path
    content: BagContent
    recover: bool
    notes: list[str] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)

    def recording(self) -> Recording:
        """Put the recording together."""
        messages = Messages(self.content, str(self.bag), self.recover)
        self.notes += self.content.notes
        found = {group: self._by_strut(messages, kind) for group, (_, kind) in TOPICS.items()}
        measured = found['acceleration']
        if not measured:
            topics = printable(', '.join(sorted(self.content.topics)), 500) or 'none'
            raise SatvibError(
                f'{self.bag}: no topic of type {PACKAGE}/StrutAcceleration in this bag, or no message on it; '
                f'topics: {topics}'
            )
        facts = facts_of(
            str(self.bag), list(messages.of(f'{PACKAGE}/Schedule')), measured, found['state']
        )
        self.notes += facts.notes
        first, count = self._span(facts.struts, measured)
        groups: dict[str, Group] = {}
        for group, by_strut in found.items():
            columns = [by_strut.get(s, []) for s in facts.struts]
            if arrays := group_arrays(columns, first, count, group, self.counts):
                groups[group] = arrays
        self._count_late(messages)
        self._count_missed(facts.struts, found['state'])
        if messages.unreadable:
            self.notes.append(f'{messages.unreadable} messages are damaged and were left out.')
        self._tell_missing(facts.struts, found)
        scenario, rig = self._setting(facts)
        realtime = self.content.custom.get('satvib_realtime') == 'true'
        if realtime and 'state' in groups:
            hold(groups['state'])
        return Recording(
            struts=facts.struts,
            sample_period=facts.sample_period,
            plan=facts.plan,
            sequence=np.arange(first, first + count, dtype=np.int64),
            stamp=_stamps(facts.struts, measured, first, count),
            groups=groups,
            scenario=scenario,
            rig=rig,
            realtime=realtime,
            seed=facts.seed,
            source=str(self.bag),
            counts=dict(self.counts),
            name=facts.scenario,
            notes=self.notes,
            is_cut=self.content.is_cut,
        )

    def _by_strut(self, messages: Messages, kind: str) -> ByStrut:
        """Messages of one type by strut, which is the last part but one of the topic."""
        by_strut: ByStrut = defaultdict(list)
        topics: dict[str, str] = {}
        for topic, message in messages.of(f'{PACKAGE}/{kind}'):
            parts = topic.strip('/').split('/')
            if len(parts) < 2:
                raise SatvibError(
                    f'{self.bag}: topic {printable(topic)} has no name of a strut before it'
                )
            strut = parts[-2]
            if topics.setdefault(strut, topic) != topic:
                raise SatvibError(
                    f'{self.bag}: {printable(strut)} is in it twice, as {printable(topics[strut])} and '
                    f'{printable(topic)}; record one graph in one bag'
                )
            by_strut[strut] += self._unpacked(message)
        return by_strut

    def _unpacked(self, message: Any) -> list[Any]:
        """The samples of a block of truth; any other message alone."""
        if getattr(message, 'samples', 0) <= 1:
            return [message]
        try:
            return truth_samples(message)
        except SatvibError as error:
            if not self.recover:
                raise SatvibError(f'{self.bag}: {error}') from None
            return []

    def _span(self, struts: tuple[str, ...], measured: ByStrut) -> tuple[int, int]:
        """First sample and number of samples."""
        there = [measured[s] for s in struts if measured.get(s)]
        if not there:
            raise SatvibError(
                f'{self.bag}: no acceleration of {printable(", ".join(struts), 200)}, which the schedule '
                f'names; there is {printable(", ".join(measured), 200)}'
            )
        most = max(len(messages) for messages in there)
        reach = MOST_PER_MESSAGE * most + _BETWEEN
        if self.recover:
            middle = int(np.median([m.sequence for m in there[0]]))
            for messages in there:
                messages[:] = [m for m in messages if abs(m.sequence - middle) < reach // 2]
        first = min(m.sequence for messages in there for m in messages)
        last = max(m.sequence for messages in there for m in messages)
        if last - first >= reach or last >= _LAST:
            raise SatvibError(
                f'{self.bag}: damaged: samples {first} to {last} in {most} messages of a strut'
            )
        return first, last - first + 1

    def _count_late(self, messages: Messages) -> None:
        """What the nodes counted as late on /diagnostics, as they said last."""
        for _, message in messages.of(DIAGNOSTICS):
            for status in message.status:
                for pair in status.values:
                    if (
                        pair.key.startswith('late')
                        and pair.value.isdecimal()
                        and len(pair.value) < 20
                    ):
                        name = f'{status.name}_{pair.key}'.strip('/').replace(' ', '_')
                        self.counts[printable(name, 100)] = int(pair.value)

    def _count_missed(self, struts: tuple[str, ...], states: ByStrut) -> None:
        for strut in struts:
            if messages := states.get(strut):
                missed = getattr(messages[-1], 'missed_samples', 0)
                self.counts[f'{strut}_samples_missed_by_controller'] = int(missed)

    def _tell_missing(self, struts: tuple[str, ...], found: dict[str, ByStrut]) -> None:
        """Say which topics are not in the recording, and which of another type stand under their names."""
        lines = []
        for group, by_strut in found.items():
            topic = TOPICS[group][0]
            missing = [s for s in struts if not by_strut.get(s)]
            if len(missing) < len(struts) and missing:
                lines.append(f'{topic} of {", ".join(missing)}')
            elif missing and group in {'voltage', 'state'}:
                lines.append(topic)
        if lines:
            self.notes.append(f'Not in this recording: {printable("; ".join(lines), 500)}.')
        known = {topic: f'{PACKAGE}/{kind}' for topic, kind in TOPICS.values()}
        for topic, kinds in sorted(self.content.topics.items()):
            wanted = known.get(topic.rpartition('/')[2])
            for kind in sorted(kinds - {wanted}) if wanted else ():
                self.notes.append(
                    f'Topic {printable(topic, 100)} has messages of type {printable(kind, 100)}, not {wanted}; '
                    'they were not read.'
                )
        others = sorted(set(found['acceleration']) - set(struts))
        if others:
            self.notes.append(
                f'Struts that the schedule does not name were left out: {printable(", ".join(others), 200)}.'
            )

    def _setting(self, facts: Facts) -> tuple[Scenario | None, AnyRig | None]:
        """Scenario and rig as the recorder left them, or those of the run's folder; None: unknown, and said so."""
        custom = self.content.custom
        scenario = _parsed(
            Scenario.from_mapping, custom.get('satvib_scenario'), f'{self.bag}: scenario'
        )
        rig = _parsed(rig_from_mapping, custom.get('satvib_rig'), f'{self.bag}: rig')
        beside = self.bag.parent / 'scenario.yaml'
        if scenario is None and beside.is_file():
            written = Scenario.from_mapping(load_yaml(beside), str(beside))
            if (written.name, written.seed) == (facts.scenario, facts.seed):
                scenario, rig = written, rig or written.load_rig()
                self.notes.append(
                    'The bag does not hold its scenario; scenario.yaml beside it was taken.'
                )
        if rig is not None and not (
            strut_count(rig) == len(facts.struts)
            and abs(rig.acquisition.sample_rate * facts.sample_period - 1.0) < 1e-6
        ):
            self.notes.append(
                'Scenario and rig in the bag do not fit its schedule; they were left out.'
            )
            return None, None
        if scenario is None or rig is None:
            called = f'The schedule names scenario {facts.scenario}. ' if facts.scenario else ''
            self.notes.append(
                f'{called}Rig, disturbance and settings are not in this bag; what needs them is left out.'
            )
        return scenario, rig


def _stamps(struts: tuple[str, ...], measured: ByStrut, first: int, count: int) -> Any:
    """Instants of the samples (count,), ns; 0 where no strut has a message."""
    stamp = np.zeros(count, dtype=np.int64)
    for strut in reversed(struts):
        for message in measured.get(strut, ()):
            at = message.header.stamp
            stamp[message.sequence - first] = at.sec * 10**9 + at.nanosec
    return stamp


def _parsed(build: Callable[[Any, str], Any], text: str | None, where: str) -> Any:
    return build(parse_yaml(text, where), where) if text else None
