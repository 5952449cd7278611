# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Units as loggers write them: what a unit is in V or in m/s^2, and the unit in the name of a column.

A table of its own, not a library of units: to pint, `g` is a gram and `m/s2` nothing. Source of the factors: The
International System of Units, 9th edition, tables 7 and 8; the foot is 0.3048 m.
"""

import re
from collections.abc import Mapping
from typing import NamedTuple

from satvib_common.errors import SatvibError

STANDARD_GRAVITY = 9.80665  # m/s^2


class Quantity(NamedTuple):
    """What a column holds.

    Attributes:
        name: for messages.
        unit: in which satvib takes it.
        scales: unit as `plain` gives it -> the size of one of it, in `unit`.
    """

    name: str
    unit: str
    scales: Mapping[str, float]


VOLTAGE = Quantity(
    'voltage',
    'V',
    {'V': 1.0, 'v': 1.0, 'Vdc': 1.0, 'volt': 1.0, 'volts': 1.0, 'mV': 1e-3, 'uV': 1e-6, 'kV': 1e3},
)
ACCELERATION = Quantity(
    'acceleration',
    'm/s^2',
    {
        'm/s^2': 1.0,
        'mm/s^2': 1e-3,
        'um/s^2': 1e-6,
        'cm/s^2': 1e-2,
        'gal': 1e-2,
        'Gal': 1e-2,
        'g': STANDARD_GRAVITY,
        'G': STANDARD_GRAVITY,
        'gn': STANDARD_GRAVITY,
        'g_n': STANDARD_GRAVITY,
        'g0': STANDARD_GRAVITY,
        'mg': 1e-3 * STANDARD_GRAVITY,
        'mG': 1e-3 * STANDARD_GRAVITY,
        'ug': 1e-6 * STANDARD_GRAVITY,
        'uG': 1e-6 * STANDARD_GRAVITY,
        'ft/s^2': 0.3048,
        'in/s^2': 0.0254,
    },
)
# units of other quantities that are known as such in round brackets and behind a slash
_OTHERS = frozenset({
    'N', 'kN', 'mN', 'Newton', 'Newtons', 'Nm', 'N*m', 'Pa', 'kPa', 'MPa', 'bar', 'm', 'mm', 'um', 'm/s', 'mm/s', 'A',
    'mA', 'K', 'C', '°C', 'degC', 'rad', 'deg', '°', 'Hz', 'kHz', 'rpm', '%', 'kg', 's', 'ms', 'us', 'ns', 'min', 'h',
})  # fmt: skip
_NONE = frozenset({'', 'none', '-', '--', '1', 'eu', 'n/a', 'unknown', 'unspecified', 'undefined'})
_SQUARE = re.compile(r'(.*?)\s*\[([^\[\]]*[^\W\d][^\[\]]*|%)\]\s*')
_ROUND = re.compile(r'(.*?)\s*\(([^()]*(?:\([^()]*\))?[^()]*)\)\s*')
_SLASH = re.compile(r'(.*?)\s+/\s+(.*)')
_NUMBER = re.compile(r'([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*\*?\s*(.*)')


def plain(unit: str) -> str:
    """Write a unit in one way: m/s², m/s2, m/s/s, m/sec^2, m*s^-2 and ms-2 are all m/s^2; '' for none."""
    text = unit.strip()
    if text[:1] in {'[', '('} and text[-1:] in {']', ')'}:
        text = text[1:-1]
    text = text.replace(' ', '')
    if text.lower() in _NONE:
        return ''
    for old, new in (
        ('⁻²', '^-2'),
        ('/s\ufffd', '/s^2'),  # of Latin-1 that was read as UTF-8
        ('²', '^2'),
        ('**', '^'),
        ('µ', 'u'),
        ('μ', 'u'),
        ('·', '*'),
        ('⋅', '*'),
    ):
        text = text.replace(old, new)
    text = text.replace('sec', 's').replace('/s/s', '/s^2').replace('(s^2)', 's^2')
    text = re.sub(r'[*.]?s\^?-2$', '/s^2', text)
    text = re.sub(r'/s2$', '/s^2', text)
    return text.lower() if text.lower() in {'volt', 'volts'} else text


def unit_in_name(name: str) -> tuple[str, str]:
    """Part a name such as `acc [g]`, `acc (m/s²)` or `a / (m/s^2)` into name and unit; unit '' where there is none.

    What is in round brackets or behind a slash counts as a unit only where it is one: `Response (Trigger)` has none.
    """
    if found := _SQUARE.fullmatch(name):
        return found[1], found[2].strip()
    for pattern in (_SLASH, _ROUND):
        if (found := pattern.fullmatch(name)) and found[1] and is_unit(found[2]):
            return found[1], found[2].strip().removeprefix('(').removesuffix(')')
    return name, ''


def is_unit(text: str) -> bool:
    """Whether a text is a unit of this table, of whatever quantity."""
    known = plain(text)
    return known in VOLTAGE.scales or known in ACCELERATION.scales or known in _OTHERS


def scale_of(unit: str, quantity: Quantity) -> float | None:
    """How large one of a unit is in that of the quantity; None where it is no unit of it.

    Args:
        unit: also with a number in front, as in `0.01 V`.
        quantity: what is measured.
    """
    known = plain(unit)
    if known in quantity.scales:
        return quantity.scales[known]
    if (found := _NUMBER.fullmatch(unit.strip())) and float(found[1]) != 0.0:
        rest = plain(found[2])
        scale = quantity.scales.get(rest) if rest else 1.0
        return None if scale is None else float(found[1]) * scale
    return None


def told_scale(option: str, unit: str, quantity: Quantity) -> float:
    """Read the unit that a person gives.

    Raises:
        SatvibError: it is no unit of the quantity.
    """
    scale = scale_of(unit, quantity)
    if scale is None:
        known = ', '.join(quantity.scales)
        raise SatvibError(
            f'{option}: {unit!r} is no unit of {quantity.name}; known: {known}, or one of them with a factor, as in '
            f"'0.01 {quantity.unit}'"
        )
    return scale
