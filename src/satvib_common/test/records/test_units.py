# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Units of headers. Truth: the SI brochure, tables 7 and 8, and 1 ft = 0.3048 m; the ways of writing, by hand."""

import pytest
from satvib_common.errors import SatvibError
from satvib_common.records.units import ACCELERATION, VOLTAGE, scale_of, told_scale, unit_in_name


@pytest.mark.parametrize(
    'unit',
    [
        'm/s^2',
        'm/s²',
        'm/s2',
        'm/s/s',
        'm/sec^2',
        'm s^-2',
        'm*s^-2',
        'ms-2',
        'ms⁻²',
        '[m/s^2]',
        '(m/s²)',
        ' m/s**2 ',
        'm/s\ufffd',
    ],
)
def test_the_many_ways_of_one_unit(unit):
    assert scale_of(unit, ACCELERATION) == 1.0


@pytest.mark.parametrize(
    ('unit', 'quantity', 'scale'),
    [
        ('g', ACCELERATION, 9.80665),
        ('mm/s²', ACCELERATION, 1e-3),
        ('ft/s2', ACCELERATION, 0.3048),
        ('mV', VOLTAGE, 1e-3),
        ('µV', VOLTAGE, 1e-6),
        ('Volts', VOLTAGE, 1.0),
        ('0.01 V', VOLTAGE, 0.01),
        ('10', VOLTAGE, 10.0),
        ('-1 g', ACCELERATION, -9.80665),
        ('1e-3*V', VOLTAGE, 1e-3),
        ('N', VOLTAGE, None),
        ('MV', VOLTAGE, None),
        ('g', VOLTAGE, None),
        ('0 V', VOLTAGE, None),
        ('', VOLTAGE, None),
    ],
)
def test_what_a_unit_is(unit, quantity, scale):
    assert scale_of(unit, quantity) == (None if scale is None else pytest.approx(scale, rel=1e-15))


@pytest.mark.parametrize(
    ('name', 'parts'),
    [
        ('acc [g]', ('acc', 'g')),
        ('acc[m/s^2]', ('acc', 'm/s^2')),
        ('acc (m/s²)', ('acc', 'm/s²')),
        ('torque [Nm]', ('torque', 'Nm')),
        ('a / (m/s^2)', ('a', 'm/s^2')),
        ('Response (Trigger)', ('Response (Trigger)', '')),
        ('Dev0/Ai0', ('Dev0/Ai0', '')),
        ('y [2]', ('y [2]', '')),
        ('u', ('u', '')),
    ],
)
def test_the_unit_in_a_name(name, parts):
    assert unit_in_name(name) == parts


def test_a_unit_that_is_none_is_refused_with_those_that_are():
    message = r"--output-unit: 'm/s\^3' is no unit of acceleration; known: m/s\^2, .*g"
    with pytest.raises(SatvibError, match=message):
        told_scale('--output-unit', 'm/s^3', ACCELERATION)
