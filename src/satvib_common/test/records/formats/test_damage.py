# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Damaged and foreign files of each format: one line that names the file and what is wrong, or the record.

Truth: the bytes of a good file, cut or changed here. A digit that was changed may be read where a format has no check
sum; an error that is not satvib's own, or one of several lines, is a defect.
"""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_common.records.any_file import list_columns
from satvib_common.records.layout import Reading
from satvib_common.records.record import column_record

QUIET = settings(
    max_examples=200, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True
)


def outcome(path, columns, reading=None):
    """What is made of a file: the record, or the line about it."""
    try:
        return column_record(path, *columns, reading=reading), ''
    except SatvibError as error:
        line = str(error)
    assert line.startswith((f'{path}: ', '--')), line
    assert '\n' not in line
    assert len(line) <= 4000 + len(str(path))
    assert line.isprintable()
    return None, line


@pytest.mark.parametrize('share', [0.0, 0.001, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99])
def test_a_file_that_is_cut_is_refused_in_one_line(written, case, share):
    """Where the format states how much there must be, that is said; else no channel is left, or the library refuses."""
    whole = written.read_bytes()
    written.write_bytes(whole[: int(share * len(whole))])
    record, line = outcome(written, case.columns)
    assert record is None
    assert line


@pytest.mark.parametrize('lost', [1, 2, 7, 8, 40])
def test_the_last_bytes_are_missed(written, case, lost):
    """Only line ends and padding at the end may be absent."""
    whole = written.read_bytes()
    written.write_bytes(whole[:-lost])
    record, line = outcome(written, case.columns)
    if record is None:
        assert line
        return
    assert set(whole[-lost:]) <= set(b'\r\n\x00') or any('cut' in note for note in record.notes)


def changed_bytes(tmp_path_factory, cases, data):
    """Change up to eight bytes of a file, mostly near its ends, and read it."""
    name = data.draw(st.sampled_from(sorted(cases)))
    case = cases[name]
    path = tmp_path_factory.mktemp('r') / f'x{case.suffix}'
    case.write(path)
    content = bytearray(path.read_bytes())
    # headers stand at the beginning of most formats, and at the end of some
    near = st.integers(0, min(2000, len(content) - 1))
    places = st.one_of(
        near, near.map(lambda i: len(content) - 1 - i), st.integers(0, len(content) - 1)
    )
    for at, byte in data.draw(
        st.lists(st.tuples(places, st.integers(0, 255)), min_size=1, max_size=8)
    ):
        content[at] = byte
    path.write_bytes(content)
    record, _ = outcome(path, case.columns)
    assert record is None or record.u.shape == record.y.shape


@QUIET
@given(data=st.data())
def test_changed_bytes_end_in_a_record_or_in_one_line(tmp_path_factory, cases, data):
    changed_bytes(tmp_path_factory, cases, data)


@pytest.mark.long
@settings(QUIET, max_examples=2500)
@given(data=st.data())
def test_many_changed_bytes_end_in_a_record_or_in_one_line(tmp_path_factory, cases, data):
    changed_bytes(tmp_path_factory, cases, data)


@pytest.mark.parametrize(
    'suffix', ['.mat', '.h5', '.tdms', '.uff', '.unv', '.wav', '.parquet', '.lvm', '.csv']
)
@pytest.mark.parametrize('seed', range(3))
def test_random_bytes_and_foreign_texts_are_refused(tmp_path, suffix, seed):
    generator = np.random.default_rng([18, 3, seed])
    path = tmp_path / f'x{suffix}'
    for content in (
        b'',
        generator.bytes(int(10 ** generator.uniform(0.0, 4.0))),
        b'<html>\n</html>\n',
    ):
        path.write_bytes(content)
        record, line = outcome(path, ('u', 'y'))
        assert record is None
        assert line


def test_the_content_counts_and_not_the_ending(written, case, tmp_path):
    """A text may have the ending of another format, and a file of a format any ending."""
    other = tmp_path / 'other.dat'
    other.write_bytes(written.read_bytes())
    record, line = outcome(other, case.columns)
    if written.read_bytes()[:2] == b'\x00\x00':  # MATLAB 4 has no mark
        assert 'control character' in line
    else:
        assert record is not None, line


@pytest.mark.parametrize('less', [0, 1, 2, 3])
@pytest.mark.parametrize('name', ['tdms', 'lvm_one', 'wav'])
def test_a_cut_recording_can_be_recovered(tmp_path, cases, name, less):
    """The samples that are there are those of the whole file, wherever within a sample the file ends."""
    case = cases[name]
    path = tmp_path / f'x{case.suffix}'
    case.write(path)
    whole = column_record(path, *case.columns)
    content = path.read_bytes()
    path.write_bytes(content[: int(0.8 * len(content)) - less])
    record, line = outcome(path, case.columns)
    assert record is None
    assert '--recover reads what is there' in line
    rescued, line = outcome(path, case.columns, Reading(recover=True))
    assert rescued is not None, line
    size = len(rescued.y)
    assert 0.5 * len(whole.y) < size < len(whole.y)
    np.testing.assert_array_equal(rescued.y, whole.y[:size])
    np.testing.assert_array_equal(rescued.u, whole.u[:size])
    assert any('is used' in note or 'is cut' in note for note in rescued.notes)


@pytest.mark.parametrize(
    ('name', 'module', 'package'),
    [
        ('mat73', 'h5py', 'h5py'),
        ('tdms', 'nptdms', 'nptdms'),
        ('uff', 'pyuff', 'pyuff'),
        ('parquet', 'pyarrow', 'pyarrow'),
    ],
)
def test_a_missing_library_is_named_with_the_command_that_installs_it(
    tmp_path, cases, monkeypatch, name, module, package
):
    """Truth: None in sys.modules is how Python says that a module cannot be imported."""
    path = tmp_path / f'x{cases[name].suffix}'
    cases[name].write(path)
    monkeypatch.setitem(__import__('sys').modules, module, None)
    line = outcome(path, ('u', 'y'))[1]
    assert line.endswith(f'{package} is missing; install it with: pip install {package}')


def test_without_columns_the_file_is_listed(written, case):
    """Every column that the case reads is in the list, and the options that choose are named."""
    record, line = outcome(written, (None, None))
    assert record is None
    assert 'name the columns with --input and --output, by name or by number; there are 1 ' in line
    assert line.endswith(list_columns(written))
    for name in case.columns:
        assert name in line
