# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""'key=value' with dots. Truth: the settings and results written here."""

import copy
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_common.settings_text import (
    assign,
    change_existing,
    change_settings,
    parse_setting,
    parse_settings,
    setting_text,
)

DATA = {'seed': 1, 'law': {'gain': 2.0}, 'phases': [{'start': 0.0}, {'start': 1.0}]}
KEYS = st.lists(st.from_regex(r'[a-z_]+', fullmatch=True), min_size=1, max_size=3).map('.'.join)
VALUES = st.recursive(
    st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.booleans() | st.none(),
    lambda inner: st.lists(inner, max_size=3),
    max_leaves=5,
)


@given(key=KEYS, value=VALUES)
def test_a_setting_that_is_written_is_read_back(key, value):
    """Numbers keep all their digits. Exact."""
    assert parse_setting(setting_text(key, value), '--set') == (key, value)


def test_settings_are_read_as_yaml_has_them_and_blank_ones_are_nothing():
    texts = ['a=1', ' b = [1, 2.5]', '', '  ', 'c=off', 'd.e={f: 1e-3}', 'g=']
    assert parse_settings(texts, 'x') == {
        'a': 1, 'b': [1, 2.5], 'c': 'off', 'd.e': {'f': 1e-3}, 'g': None,
    }  # fmt: skip


@pytest.mark.parametrize('text', ['seed', '=3', '.a=3', 'a..b=3', 'a.=3'])
def test_what_is_not_key_and_value_is_refused(text):
    with pytest.raises(SatvibError, match=rf'^--set {re.escape(text)}: key=value is expected'):
        parse_setting(text, '--set')


def test_the_settings_of_a_scenario_may_add_keys():
    """Keys that are not there are made, for a schema to judge; those of the rig stay apart."""
    data = copy.deepcopy(DATA)
    change_settings(data, ['law.gain=3.0', 'phases.1.start=9', 'a.b=1', 'rig.coil.r=2', 'rig=x'])
    assert data == {
        'seed': 1, 'law': {'gain': 3.0}, 'phases': [{'start': 0.0}, {'start': 9}], 'a': {'b': 1},
        'rig_overrides': {'coil.r': 2}, 'rig': 'x',
    }  # fmt: skip


BAD = {
    'seed.x': 'here: seed.x: seed has no keys below it',
    'phases.2.start': 'here: phases.2.start: phases.2 has no keys below it or does not exist',
    'phases.2': 'here: phases.2: 2 is not an index from 0 to 1',
    'sed': 'here: sed: no such key (known here: seed, law, phases)',
    'law': 'here: law: is a group of keys, name one of gain',
}


@pytest.mark.parametrize('key', BAD)
def test_a_change_to_what_exists_names_the_key_that_does_not_fit(key):
    data = copy.deepcopy(DATA)
    with pytest.raises(SatvibError) as refused:
        change_existing(data, {key: 5}, 'here')
    assert str(refused.value).startswith(BAD[key])
    assert data == DATA


def test_a_new_key_below_a_number_is_refused_in_a_growing_mapping_too():
    with pytest.raises(SatvibError, match='seed has no keys below it'):
        assign(copy.deepcopy(DATA), 'seed.x', 1, 'here', grow=True)
