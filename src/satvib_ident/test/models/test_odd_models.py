# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Model files with values that are none: one line. Truth: by hand; found by 100 000 damaged files."""

import pytest
from satvib_common.errors import SatvibError
from satvib_ident.models.model_file import load_model


@pytest.mark.parametrize(
    'change',
    [
        ('delay: 0', 'delay: .inf'),
        ('delay: 0', 'delay: 1e999999999'),
        ('delay: 0', 'delay: .nan'),
        ('delay: 0', '\u014b\u070ey: 0'),
        ('delay: 0', '"\\x1b[31m": 0'),
        ('sample_period: 0.01', 'sample_period: -1e308'),
        ('[-1.5, 0.7]', '[.inf, 0.7]'),
        ('[-1.5, 0.7]', '[[1], 0.7]'),
    ],
)
def test_a_value_that_is_none(tmp_path, change):
    text = (
        'format: satvib-model-1\nmodel:\n  delay: 0\n  sample_period: 0.01\n  a: [-1.5, 0.7]\n'
        '  b: [0.0, 1.0]\nabout: {}\n'
    )
    path = tmp_path / 'm.yaml'
    path.write_text(text.replace(*change), encoding='utf-8')
    with pytest.raises(SatvibError) as caught:
        load_model(path)
    assert str(caught.value).isprintable()
