# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The page docs/faults.md: the faults of the list, what must happen, and what was measured."""

import re
from collections.abc import Mapping, Sequence

from elsewhere import OTHERS
from faults import CHAPTERS, IN_CONTROL, IN_EACH, RATE, Fault, Must
from play import GUARD, Outcome
from strut import TIMEOUT

BEGIN, END = '<!-- faults: written by benchmarks/faults.py -->', '<!-- end of faults -->'
OTHERS_BEGIN, OTHERS_END = BEGIN.replace('faults', 'others', 1), '<!-- end of others -->'
_HEAD = (
    '| fault | what must become of the voltage | 0 V within | 0 V after | calm within | calm after | largest V |\n'
    '|---|---|---:|---:|---:|---:|---:|'
)


def _seconds(samples: float | None) -> str:
    return '' if samples is None else f'{samples / RATE:.2f} s'


def limit_of(fault: Fault) -> int | None:
    """Samples within which 0 V must be there; None: no 0 V is asked for."""
    if fault.must not in {Must.ZERO, Must.LATCHED}:
        return None
    return fault.within + (round(TIMEOUT * RATE) if fault.silence else 0)


def name_of(fault: Fault) -> str:
    """Its name, and the phases where that is not CONTROL alone."""
    if fault.phases == IN_CONTROL:
        return fault.name
    where = 'in each phase' if fault.phases == IN_EACH else f'in {fault.phases[0].name}'
    return f'{fault.name}; {where}'


def must_of(fault: Fault) -> str:
    """What must become of the voltage, in words."""
    louder = (
        f' within {fault.louder:g} dB' if fault.must is Must.STEADY and fault.louder != 2.0 else ''
    )
    return fault.must.value + louder


def back_of(fault: Fault) -> int | None:
    """Samples within which it is as before; None: the graph has ended."""
    return None if fault.must is Must.ENDS else fault.back


def row(fault: Fault, outcomes: Sequence[Outcome]) -> str:
    """One line: the worst of the outcomes."""
    zero = max((o.zero for o in outcomes if o.zero is not None), default=None)
    back = max((o.back for o in outcomes if o.back is not None), default=None)
    peak = max((o.peak for o in outcomes), default=None)
    cells = [
        name_of(fault), must_of(fault), _seconds(limit_of(fault)), _seconds(zero), _seconds(back_of(fault)),
        _seconds(back), '' if peak is None else f'{peak:.1f}',
    ]  # fmt: skip
    return f'| {" | ".join(cells)} |'


def tables(outcomes: Mapping[str, Sequence[Outcome]]) -> str:
    """All chapters as Markdown; outcomes by the name of the fault."""
    parts = []
    for heading, faults in CHAPTERS.items():
        rows = [row(fault, outcomes.get(fault.name, ())) for fault in faults]
        parts.append('\n'.join([f'### {heading}', '', _HEAD, *rows]))
    return '\n\n'.join(parts)


def named(page: str) -> list[tuple[str, str, str, str]]:
    """What a page lists: fault, what must happen, and the two limits, in order."""
    made = page.split(BEGIN)[1].split(END)[0]
    lines = re.findall(r'^\| (.+) \|$', made, re.MULTILINE)
    cells = [[c.strip() for c in line.split(' | ')] for line in lines]
    return [(c[0], c[1], c[2], c[4]) for c in cells if c[0] != 'fault']


def listed() -> list[tuple[str, str, str, str]]:
    """The same of the list of faults."""
    return [
        (name_of(f), must_of(f), _seconds(limit_of(f)), _seconds(back_of(f)))
        for faults in CHAPTERS.values()
        for f in faults
    ]


def write(page: str, outcomes: Mapping[str, Sequence[Outcome]], rounds: int) -> str:
    """Give the page with new tables; outcomes by the name of the fault."""
    before, after = page.split(BEGIN)[0], page.split(END)[1]
    line = (
        f'Worst of {rounds} round{"s" if rounds > 1 else ""}; {RATE} samples a second, '
        f'`command_timeout` {TIMEOUT:g} s, guard {GUARD:g} V.'
    )
    page = f'{before}{BEGIN}\n\n{line}\n\n{tables(outcomes)}\n\n{END}{after}'
    before, after = page.split(OTHERS_BEGIN)[0], page.split(OTHERS_END)[1]
    return f'{before}{OTHERS_BEGIN}\n\n{others()}\n\n{OTHERS_END}{after}'


def others() -> str:
    """The faults that have a test of their own, as Markdown."""
    rows = [
        f'| {o.name} | {o.must} | `{o.test.partition("::")[2]}` in `{o.test.partition("::")[0]}` |'
        for o in OTHERS
    ]
    return '\n'.join(['| fault | what must happen | test |', '|---|---|---|', *rows])
