# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a bag says of its run: by its schedule, or by the messages of the struts where the schedule was not recorded."""

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from satvib_common.errors import SatvibError, printable
from satvib_common.phases import Phase, PhasePlan

_PERIODS = (1e-7, 1e3)  # s
_MOST_STRUTS = 1000
# of schedules that differ, so many are looked at, and of samples about so many
_CANDIDATES, _ASKED = 100, 2000


@dataclass(frozen=True)
class Facts:
    """What is known of a run.

    Attributes:
        scenario: its name; '' when it is not known.
        struts: their names.
        sample_period: s.
        plan: phases by sample.
        seed: of everything random; 0 when it is not known.
        notes: what is to be said.
    """

    scenario: str
    struts: tuple[str, ...]
    sample_period: float
    plan: PhasePlan
    seed: int = 0
    notes: list[str] = field(default_factory=list)


def facts_of(
    bag: str,
    schedules: list[tuple[str, Any]],
    measured: dict[str, list[Any]],
    states: dict[str, list[Any]],
) -> Facts:
    """Give the facts of a run.

    Args:
        bag: its name, for the errors.
        schedules: topic and message of each schedule. A stranger may have sent some: the one that the struts followed
            counts, of several such the last one.
        measured: messages of acceleration by strut.
        states: messages of controllers by strut.

    Raises:
        SatvibError: a schedule that is none, or nothing that tells the phases.
    """
    if not schedules:
        return _without_schedule(bag, measured, states)
    if len({topic for topic, _ in schedules}) > 1:
        listed = ', '.join(sorted({topic for topic, _ in schedules}))
        raise SatvibError(
            f'{bag}: several schedules: {printable(listed, 200)}; record one graph in one bag'
        )
    schedule, plan = _followed(bag, [message for _, message in schedules], states)
    struts = tuple(schedule.struts)
    if not struts or len(struts) > _MOST_STRUTS or not all(s and s.isprintable() for s in struts):
        raise SatvibError(f'{bag}: the schedule names no struts')
    notes = []
    if any(_key(schedule) != _key(other) for _, other in schedules):
        notes.append(
            f'The recording holds {len(schedules)} schedules that differ; the one that the struts followed counts.'
        )
    return Facts(
        scenario=printable(schedule.scenario, 200),
        struts=struts,
        sample_period=_period(bag, schedule.sample_period, 'the schedule'),
        plan=plan,
        seed=int(schedule.seed),
        notes=notes,
    )


def _key(schedule: Any) -> tuple[Any, ...]:
    """What two equal schedules have in common."""
    return (
        tuple(schedule.first_sequence),
        tuple(schedule.phases),
        int(schedule.end_sequence),
        tuple(schedule.struts),
        schedule.sample_period,
    )


def _followed(
    bag: str, schedules: list[Any], states: dict[str, list[Any]]
) -> tuple[Any, PhasePlan]:
    """Give the schedule whose phases the controllers said, and its plan; the last one where none said any."""
    distinct = list({_key(s): s for s in schedules}.values())
    if len(distinct) == 1:
        return distinct[0], _plan(bag, distinct[0])
    said = {int(m.sequence): int(m.phase) for messages in states.values() for m in messages}
    some = sorted(said)[:: max(len(said) // _ASKED, 1)]
    best, most, refused = None, -1, None
    for schedule in distinct[:_CANDIDATES]:
        try:
            plan = _plan(bag, schedule)
        except SatvibError as error:
            refused = error
            continue
        fits = sum(plan.at(k) == said[k] and not 0 < plan.end <= k for k in some)
        if fits >= most:
            best, most = (schedule, plan), fits
    if best is None:
        assert refused is not None
        raise refused
    return best


def _plan(bag: str, schedule: Any) -> PhasePlan:
    return PhasePlan(
        tuple(_phase(bag, p) for p in schedule.phases),
        tuple(int(k) for k in schedule.first_sequence),
        int(schedule.end_sequence),
    )


def _without_schedule(
    bag: str, measured: dict[str, list[Any]], states: dict[str, list[Any]]
) -> Facts:
    """Facts by the messages of the struts."""
    phases: dict[int, int] = {}
    for messages in states.values():
        for message in messages:
            phases.setdefault(int(message.sequence), int(message.phase))
    if not phases:
        raise SatvibError(
            f'{bag}: the schedule was not recorded, and no controller_state either: the phases are not known. '
            'Record /schedule too; it is latched, so a recorder that begins late gets it'
        )
    changes: list[tuple[Phase, int]] = []
    for sequence in sorted(phases):
        phase = _phase(bag, phases[sequence])
        if not changes or changes[-1][0] is not phase:
            changes.append((phase, sequence if changes else 0))
    periods = Counter(
        getattr(m, 'sample_period', 0.0) for messages in measured.values() for m in messages
    )
    return Facts(
        scenario='',
        struts=tuple(sorted(measured, key=lambda name: (len(name), name))),
        sample_period=_period(bag, periods.most_common(1)[0][0], 'the accelerations'),
        plan=PhasePlan(tuple(p for p, _ in changes), tuple(k for _, k in changes)),
        notes=['The schedule was not recorded; struts and phases are as their messages say.'],
    )


def _phase(bag: str, number: Any) -> Phase:
    try:
        return Phase(int(number))
    except ValueError:
        raise SatvibError(f'{bag}: damaged: there is no phase {int(number)}') from None


def _period(bag: str, period: Any, what: str) -> float:
    if not isinstance(period, float) or not _PERIODS[0] <= period <= _PERIODS[1]:
        raise SatvibError(
            f'{bag}: sample period {period} s of {what} is not from {_PERIODS[0]:g} to {_PERIODS[1]:g} s'
        )
    return period
