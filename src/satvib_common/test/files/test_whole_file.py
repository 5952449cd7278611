# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Files that appear whole or not at all."""

import pytest
from satvib_common.errors import SatvibError
from satvib_common.files.whole_file import write_whole


def test_a_file_is_replaced_and_nothing_is_left_beside_it(tmp_path):
    """Truth: the folder's contents."""
    path = tmp_path / 'kept'
    path.write_bytes(b'old')
    write_whole(path, lambda sink: sink.write(b'new'))
    assert path.read_bytes() == b'new'
    assert list(tmp_path.iterdir()) == [path]


def test_what_breaks_while_it_is_written_leaves_the_old_file(tmp_path):
    """A disk that is full; truth: the old bytes, and one line that names the file and says why."""

    def full(sink):
        sink.write(b'half')
        raise OSError(28, 'No space left on device')

    path = tmp_path / 'kept'
    path.write_bytes(b'old')
    with pytest.raises(SatvibError, match='kept: cannot be written: No space left'):
        write_whole(path, full)
    assert path.read_bytes() == b'old'
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_not_there_is_named(tmp_path):
    """One line, no traceback."""
    with pytest.raises(SatvibError, match='nowhere/kept: cannot be written'):
        write_whole(tmp_path / 'nowhere' / 'kept', lambda sink: sink.write(b''))
