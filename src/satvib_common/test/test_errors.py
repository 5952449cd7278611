# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The errors that people see. Truth: `str.isprintable`, and the text itself where a terminal may show it."""

import pickle

import pytest
from satvib_common.errors import RunError, SatvibError


@pytest.mark.parametrize('kind', [SatvibError, RunError])
def test_an_error_that_quotes_a_damaged_file_is_one_line(kind):
    """A terminal obeys control characters."""
    assert str(kind('a.lvm: u is over \x81ime\n\x1b[2J')) == 'a.lvm: u is over \\x81ime\\n\\x1b[2J'
    assert str(kind('Größe 3 µm: zu groß')) == 'Größe 3 µm: zu groß'
    assert len(str(kind('x' * 10_000))) == 4000
    assert str(pickle.loads(pickle.dumps(kind('as it was')))) == 'as it was'
