# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Schemas: what is refused, and with which words. Truth: the rule that each field states."""

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml, parse_yaml
from satvib_common.schema import Schema, param


@dataclass(frozen=True, kw_only=True)
class Coil(Schema):
    resistance: float = param(2.7, 'winding resistance', unit='ohm', above=0.0)
    drive: str = param('voltage', 'drive', choices=('voltage', 'current'))


@dataclass(frozen=True, kw_only=True)
class Rig(Schema):
    name: str = param(description='name')
    stiffness: tuple[float, ...] = param((1.0,), 'stiffness', unit='N/m', above=0.0)
    coil: Coil = param(Coil(), 'coil')
    sensors: tuple[Coil, ...] = param((), 'a list of schemas')
    seed: int | None = param(None, 'seed', minimum=0)
    lower: float = param(0.0, 'lower end')
    upper: float = param(1.0, 'upper end')

    def check(self):
        if self.upper <= self.lower:
            raise SatvibError(f'upper: {self.upper} is not above lower {self.lower}')


@pytest.mark.parametrize(
    ('mapping', 'message'),
    [
        ({}, 'file: name: missing'),
        ({'nmae': 'a'}, 'file: nmae: no such key; did you mean name?'),
        ({'name': 3}, 'file: name: text is expected, not int 3'),
        (
            {'name': 'a', 'seed': True},
            'file: seed: a whole number or nothing is expected, not bool',
        ),
        (
            {'name': 'a', 'seed': 1.5},
            'file: seed: a whole number or nothing is expected, not float',
        ),
        ({'name': 'a', 'stiffness': [1, -2]}, 'file: stiffness: -2.0 is not above 0.0 N/m'),
        ({'name': 'a', 'stiffness': [1, 'x']}, r'file: stiffness\[1\]: a number is expected'),
        ({'name': 'a', 'stiffness': 3}, 'file: stiffness: a list of a number is expected'),
        (
            {'name': 'a', 'coil': {'resistance': 0}},
            'file: coil.resistance: 0.0 is not above 0.0 ohm',
        ),
        ({'name': 'a', 'coil': {'drive': 'steam'}}, "file: coil.drive: 'steam' is not one of"),
        ({'name': 'a', 'coil': 3}, 'file: coil: a Coil is expected'),
        ({'name': 'a', 'sensors': [{}, {'r': 1}]}, r'file: sensors\[1\].r: no such key'),
        ({'name': 'a', 'lower': float('nan')}, 'file: lower: nan is not a finite number'),
        ({'name': 'a', 'lower': 2}, 'file: upper: 1.0 is not above lower 2.0'),
        ([1], 'file: a mapping of keys is expected'),
        (None, 'file: a mapping of keys is expected, not nothing'),
    ],
)
def test_bad_input_is_refused_in_one_line_that_names_it(mapping, message):
    with pytest.raises(SatvibError, match=message) as caught:
        Rig.from_mapping(mapping, 'file')
    assert '\n' not in str(caught.value)


@given(
    st.text(min_size=1),
    st.lists(st.floats(1e-6, 1e6), min_size=1, max_size=4),
    st.floats(1e-3, 1e3),
    st.none() | st.integers(0, 2**40),
)
def test_mapping_round_trip(name, stiffness, resistance, seed):
    """Truth: identity."""
    rig = Rig(name=name, stiffness=tuple(stiffness), coil=Coil(resistance=resistance), seed=seed)
    assert Rig.from_mapping(rig.to_mapping()) == rig


def test_replace_checks_the_whole_again():
    with pytest.raises(SatvibError, match='upper'):
        Rig(name='a').replace(lower=5.0)


def test_yaml_duplicate_key_and_number_forms(tmp_path):
    """Truth: YAML 1.2 reads 1e-3 as a number; a key given twice hides one of its values."""
    assert parse_yaml('a: 1e-3', 'x') == {'a': 1e-3}
    with pytest.raises(SatvibError, match='x: line 2: a is given twice'):
        parse_yaml('a: 1\na: 2', 'x')
    with pytest.raises(SatvibError, match='not YAML'):
        parse_yaml('a: [1', 'x')
    empty = tmp_path / 'empty.yaml'
    empty.write_text('')
    with pytest.raises(SatvibError, match='is empty'):
        load_yaml(empty)
    with pytest.raises(SatvibError, match='cannot be read'):
        load_yaml(tmp_path / 'missing.yaml')
