# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""YAML within bounds. Truth: `yaml.safe_load`, the bounds of the module, and lines counted by hand."""

import contextlib
import json
import time

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import DEEPEST, LARGEST_FILE, load_yaml, parse_yaml

MERGES = (
    'a: &a {x: 1, y: 2}\nb: {<<: *a, y: 3}',
    'a: &a {x: 1}\nb: &b {<<: *a, y: 2}\nc: {<<: [*b, {z: 3}], x: 4}',
    'a: &a {x: 1}\nb:\n  x: 2\n  <<: *a',
    'a: &a {p: [1, 2]}\nb: [{<<: *a}, {<<: *a, q: 1}]',
)
BOMB = '\n'.join(
    ['a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]']
    + [f'a{i}: &a{i} [{", ".join([f"*a{i - 1}"] * 9)}]' for i in range(1, 20)]
)
MERGE_BOMB = '\n'.join(
    ['a0: &a0 {x: 1}']
    + [f'a{i}: &a{i} {{<<: [{", ".join([f"*a{i - 1}"] * 9)}]}}' for i in range(1, 20)]
)


@pytest.mark.parametrize('text', MERGES)
def test_merge_keys_are_those_of_pyyaml(text):
    assert parse_yaml(text, 'x') == yaml.safe_load(text)


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('a: 1\nb: {{ duration }}', 'line 2: a key is expected.*template'),
        ('a:\n  b: {{x}: 1}', 'line 2: a key is expected'),
        ('? [1, 2]\n: 3', 'line 1: a key is expected'),
        ('a: {% if x %}', 'line 1: not YAML'),
        ('a: 1\nb: 2026-13-45', 'line 2: 2026-13-45 is a date'),
        ('a: 2026-02-30 25:61:00', 'line 1: 2026-02-30 25:61:00 is a date'),
        ('a: ' + '9' * 400, 'line 1: a number of 400 digits'),
        ('a: ' + '9' * 5000, 'line 1: 9999.* has no value'),
        ('a: 0x' + 'f' * 5000, 'line 1: a number of 5002 digits'),
        ('a: 0x_', 'line 1: 0x_ has no value'),
        ('a: !!int ""', 'line 1: .*has no value'),
        ('a: !!binary aGk=', 'line 1: the tag binary is not known'),
        ('a: !!python/object:os.system x', 'line 1: the tag python/object:os.system is not'),
        ('a: 1\n<<: 3', 'line 2: not YAML: .*mapping'),
        ('a: 1\nb: 2\na: 3', 'line 3: a is given twice'),
        ('[' * 100_000, f'line 1: nested deeper than {DEEPEST}'),
        ('- ' * 5000, f'line 1: nested deeper than {DEEPEST}'),
        ('{a: ' * 5000, f'line 1: nested deeper than {DEEPEST}'),
        (BOMB, 'line 6: more than 100000 values'),
        (MERGE_BOMB, 'line 6: more than 100000 values'),
        ('&a [1, *a]', 'line 1: an alias of what it lies in'),
        ('a: &a {b: *a}', 'line 1: an alias of what it lies in'),
        ('a: *nothing', 'line 1: not YAML: found undefined alias'),
        ('a: 1\nb: "\\uD800"', "line 2: '?.ud800 holds half a character"),
        ('a: 1\nb: \x00', 'line 2: not YAML: the character U.0000'),
        ('a: "\\UFFFFFFFF"', 'not YAML'),
        ('a: 1\n---\na: 2', 'line 2: not YAML'),
        ('a: 1\n\tb: 2', 'line 2: not YAML'),
        ('x' * (LARGEST_FILE + 1), f'longer than {LARGEST_FILE}'),
    ],
)
def test_what_is_no_setting_is_refused_in_one_short_line(text, message):
    with pytest.raises(SatvibError, match=f'^x: {message}') as caught:
        parse_yaml(text, 'x')
    assert len(str(caught.value)) < 300
    assert '\n' not in str(caught.value)


def test_surrogate_pairs_as_json_writes_them_are_one_character():
    """Truth: the text that JSON was made of."""
    assert parse_yaml(json.dumps({'a': '\U0001f600'}), 'x') == {'a': '\U0001f600'}


def test_a_file_that_is_no_text(tmp_path):
    """Truth: the bytes written."""
    path = tmp_path / 'a.yaml'
    path.write_bytes('a: ü'.encode('latin-1'))
    with pytest.raises(SatvibError, match=r'not UTF-8 text \(byte 3'):
        load_yaml(path)
    path.write_bytes(b'\xef\xbb\xbfa: 1')
    assert load_yaml(path) == {'a': 1}
    with pytest.raises(SatvibError, match='cannot be read'):
        load_yaml(tmp_path / 'a\0b')


PIECES = st.sampled_from(
    [*'{}[]:,-?|>*&!%@`#"\' \n', '<<: ', '&a ', '*a ', '{{ x }}', '- ', ': ', '? ', '1e999', '.inf',
     '2026-13-45', '0x', '1:99', '!!int ', '!!set ', '!!omap ', '\\uD800', '\x1b', '---\n', '~', 'a']
)  # fmt: skip


@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(st.one_of(PIECES, st.text(max_size=3)), max_size=40).map(''.join))
def test_any_text_is_read_or_refused(text):
    """Truth: nothing but a `SatvibError` may be raised, and what is read is plain data that JSON holds."""
    began = time.process_time()
    with contextlib.suppress(SatvibError):
        json.dumps(parse_yaml(text, 'x'))
    assert time.process_time() - began < 2.0  # a hang, not a speed
