# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of a judgement as Markdown, and its numbers as plain data."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from satvib_common.arrays import Array

from satvib_studies.isolation.cases import OPEN, Isolation
from satvib_studies.isolation.numbers import Judged, judged
from satvib_studies.isolation.runs import LawFound

Found = Mapping[tuple[str, str], LawFound]
_SAID = 0.1  # share of CONTROL from which a reason is shown


def titles(isolation: Isolation, laws: Sequence[str]) -> dict[str, str]:
    """Give the names of the rows, the open loop first."""
    return {OPEN: 'open loop', **{law: isolation.law_list()[law].title for law in laws}}


def rows_of(isolation: Isolation, found: Found, rig: str, laws: Sequence[str]) -> dict[str, Judged]:
    """Give the figures of every law on a rig, the open loop first."""
    still = found[rig, OPEN].curves
    return {law: judged(found[rig, law].curves, still, isolation.roll_off) for law in (OPEN, *laws)}


class _Notes:
    """Texts with numbers, in the order in which they come."""

    def __init__(self) -> None:
        self.numbers: dict[str, int] = {}

    def marks(self, reasons: Mapping[str, float]) -> str:
        """Give the marks of the reasons that were given often."""
        given = [text for text, share in reasons.items() if share >= _SAID]
        numbers = sorted(self.numbers.setdefault(text, len(self.numbers) + 1) for text in given)
        return ''.join(f' [{n}]' for n in numbers)

    def lines(self) -> list[str]:
        """Give what stands below the table."""
        return (
            ['', *(f'[{n}] {text}.  ' for text, n in self.numbers.items())] if self.numbers else []
        )


def transmissibility_table(
    isolation: Isolation, found: Found, rig: str, laws: Sequence[str]
) -> str:
    """Give peaks, roll-off and amplification of every law on a rig."""
    low, high = isolation.roll_off
    heads = (
        'peak dB', 'at Hz', 'isolation from Hz', f'roll-off, {low:g} to {high:g} Hz, dB/decade',
        'amplification over open loop dB', 'at Hz', 'worst strut, peak dB', 'worst tilt, peak dB', 'V RMS',
    )  # fmt: skip
    lines = ['| law | ' + ' | '.join(heads) + ' |', '|---|' + '---:|' * len(heads)]
    notes, names = _Notes(), titles(isolation, laws)
    for law, row in rows_of(isolation, found, rig, laws).items():
        mine = found[rig, law]
        still = law == OPEN
        cells = [
            _spread(row.peak), _median(row.peak_at), _spread(row.isolation_from, '.1f'),
            _spread(row.roll_off), '–' if still else _spread(row.worse),
            '–' if still else _median(row.worse_at), _spread(row.strut_peak), _spread(row.tilt_peak),
            _median(mine.base_voltage, '.3f'),
        ]  # fmt: skip
        lines.append(
            f'| {names[law]}{notes.marks(mine.base_reasons)} | ' + ' | '.join(cells) + ' |'
        )
    return '\n'.join([*lines, *notes.lines()]) + '\n'


def sight_table(isolation: Isolation, found: Found, rig: str, laws: Sequence[str]) -> str:
    """Give the line of sight of every law on a rig while a wheel runs up."""
    heads = ('line of sight, arc seconds RMS', 'V RMS')
    lines = ['| law | ' + ' | '.join(heads) + ' |', '|---|' + '---:|' * len(heads)]
    notes, names = _Notes(), titles(isolation, laws)
    for law, name in names.items():
        mine = found[rig, law]
        cells = [_spread(mine.sight, '.1f'), _median(mine.wheel_voltage, '.3f')]
        lines.append(f'| {name}{notes.marks(mine.wheel_reasons)} | ' + ' | '.join(cells) + ' |')
    return '\n'.join([*lines, *notes.lines()]) + '\n'


def _spread(values: float | Array, form: str = '+.1f') -> str:
    """Median, smallest and largest of what is known."""
    known = np.asarray(values)[np.isfinite(values)]
    if not known.size:
        return '–'
    shown = f'{np.median(known):{form}}'
    return f'{shown} ({known.min():{form}} … {known.max():{form}})' if known.size > 1 else shown


def _median(values: float | Array, form: str = '.1f') -> str:
    known = np.asarray(values)[np.isfinite(values)]
    return f'{np.median(known):{form}}' if known.size else '–'


def page_tables(
    isolation: Isolation, found: Found, rigs: Sequence[str], laws: Sequence[str]
) -> dict[str, str]:
    """Give all tables by the marks of the page that they belong to."""
    made = {f'judge {rig}': transmissibility_table(isolation, found, rig, laws) for rig in rigs}
    return made | {
        f'judge {rig}, line of sight': sight_table(isolation, found, rig, laws) for rig in rigs
    }


def plain(
    isolation: Isolation, found: Found, rigs: Sequence[str], laws: Sequence[str]
) -> dict[str, Any]:
    """Give the numbers: by rig and law, seed by seed; None where one is not known."""
    result: dict[str, Any] = {'isolation': isolation.to_mapping(), 'rigs': {}}
    for rig in rigs:
        rows = rows_of(isolation, found, rig, laws)
        result['rigs'][rig] = {
            law: {
                **{name: _known(values) for name, values in asdict(row).items()},
                'line_of_sight': _known(found[rig, law].sight),
                'base_voltage': _known(found[rig, law].base_voltage),
                'wheel_voltage': _known(found[rig, law].wheel_voltage),
                'base_reasons': found[rig, law].base_reasons,
                'wheel_reasons': found[rig, law].wheel_reasons,
            }
            for law, row in rows.items()
        }
    return result


def _known(values: Array) -> list[float | None]:
    return [float(v) if math.isfinite(v) else None for v in values]
