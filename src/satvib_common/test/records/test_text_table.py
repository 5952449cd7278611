# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Text files of every layout: the numbers that were written come back, or the line is named.

Truth everywhere: the arrays that were written, to the digits that were written.
"""

import string
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_common.records.any_file import has_columns, read_table
from satvib_common.records.layout import Reading
from satvib_common.records.record import column_record
from satvib_common.records.text_rows import seconds

T = 0.01 * np.arange(60)
U = np.where(np.random.default_rng([1]).random(60) < 0.5, -1.0, 1.0)
Y = np.round(np.random.default_rng([2]).normal(size=60), 5)
QUIET = settings(
    max_examples=60, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True
)


def text_of(separator=',', decimal='.', header=('t', 'u', 'y'), columns=(T, U, Y), end='\n'):
    """A text file of columns."""
    rows = [
        separator.join(f'{v:.5f}'.replace('.', decimal) for v in row)
        for row in zip(*columns, strict=True)
    ]
    return end.join([*([separator.join(header)] if header else []), *rows, ''])


@pytest.fixture
def read(tmp_path):
    """Write a file and read u, y: read(text or bytes, u, y, name, reading) -> Table."""

    def run(content, u='u', y='y', name='r.csv', reading=None, time=None):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_table(path, [u, y], time, reading)

    return run


def same(table):
    np.testing.assert_array_equal(table.columns[0], U)
    np.testing.assert_array_equal(table.columns[1], Y)
    return True


@pytest.mark.parametrize('separator', [',', ';', '\t', '|', ' ', '   '])
@pytest.mark.parametrize('decimal', ['.', ','])
@pytest.mark.parametrize('end', ['\n', '\r\n', '\r', '\r\r\n'])
def test_separators_decimal_signs_and_line_ends_are_found_out(read, separator, decimal, end):
    """Commas that do both are the one pair that cannot be told apart."""
    text = text_of(separator, decimal, end=end)
    if separator == decimal:
        with pytest.raises(SatvibError, match=r'line 2: the row has 6 cells, the header 3'):
            read(text)
    else:
        table = read(text)
        assert same(table)
        np.testing.assert_allclose(table.time, T, atol=1e-12)


@pytest.mark.parametrize(
    'encoding',
    ['utf-8', 'utf-8-sig', 'utf-16', 'utf-16-le', 'utf-16-be', 'utf-32', 'latin-1', 'cp1252'],
)
def test_encodings(read, encoding):
    text = text_of(';', ',', header=('Zeit', 'Kraft', 'Beschl (m/s²)'))
    assert same(read(text.encode(encoding), 'Kraft', 'Beschl (m/s²)'))
    if not encoding.endswith('e'):  # without a mark and told
        assert same(
            read(
                text.encode(encoding), 'Kraft', 'Beschl (m/s²)', reading=Reading(encoding=encoding)
            )
        )


LABVIEW = (
    'LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n***End_of_Header***\t\n'
    'Channels\t2\t\t\nSamples\t60\t60\nX0\t0,0\t0,0\nDelta_X\t0,01\t0,01\n***End_of_Header***\t\t\n'
)


@pytest.mark.parametrize(
    ('text', 'names'),
    [
        ('sep=;\n' + text_of(';', ','), 'uy'),
        ('"sep=|"\n' + text_of('|'), 'uy'),
        ('Logger 4711\nDate;2024-03-01\nRate;100\n\n' + text_of(';', ','), 'uy'),
        ('# made by hand\n# u in V\n' + text_of(' '), 'uy'),
        ('Samples,60,60\nGain,1.0,2.0\nChannels: u and y\n' + text_of(','), 'uy'),
        (text_of().replace('t,u,y\n', 't,u,y\ns,V,m/s^2\n'), 'uy'),
        (text_of().replace('t,u,y\n', 't,u,y\n[s],[V],[m/s^2]\n\n'), 'uy'),
        (LABVIEW + text_of('\t', ',', header=('X_Value', 'u', 'y', 'Comment')), 'uy'),
        (LABVIEW.replace('tor\t,', 'tor\t.') + text_of('\t', header=('X_Value', 'u', 'y', 'Comment')), 'uy'),
        (text_of(header=()), '23'),
        (text_of(' ', header=()), '23'),
        (text_of(), '23'),
        ('\n'.join(line + ';' for line in text_of(';', ',').split('\n')[:-1]) + '\n', 'uy'),
        (text_of(header=('t', '"u"', '"y"')), 'uy'),
        (text_of().replace(',1.00000', ',"1.00000"'), 'uy'),
        (text_of(header=('t', 'u', 'y'), columns=(T, U, Y)) + '\n\n\n', 'uy'),
        (text_of() + '\x1a', 'uy'),
        (text_of(', '), 'uy'),
    ],
)  # fmt: skip
def test_preambles_units_and_columns_by_number(read, text, names):
    assert same(read(text, names[0], names[1]))


def test_what_is_told_is_used(read):
    """A file of whole numbers separated by commas could also hold decimal commas."""
    rows = ''.join(f'{i},{i % 3},{i % 7}\n' for i in range(50))
    plain = read('t,u,y\n' + rows)
    np.testing.assert_array_equal(plain.columns[1], np.arange(50) % 7)
    told = read(
        'u;y\n' + ''.join(f'{i},5;{i % 3}\n' for i in range(50)),
        reading=Reading(';', ',', 'utf-8', 0),
    )
    np.testing.assert_array_equal(told.columns[0], np.arange(50) + 0.5)
    skipped = read('9,9,9\nu,y,z\n1,2,3\n' + text_of(), reading=Reading(skip=3))
    assert same(skipped)


def test_marks_of_missing_values_are_gaps(read):
    text = text_of().split('\n')
    for row, mark in (
        (5, ''),
        (6, 'nan'),
        (7, 'N/A'),
        (8, '-'),
        (9, '1.#QNAN'),
        (10, 'inf'),
        (11, 'NULL'),
    ):
        cells = text[row].split(',')
        text[row] = ','.join([cells[0], cells[1], mark])
    table = read('\n'.join(text))
    assert np.flatnonzero(np.isnan(table.columns[1])).tolist() == [4, 5, 6, 7, 8, 9, 10]
    assert any('1 values are infinite' in note for note in table.notes)


@pytest.mark.parametrize(
    ('change', 'message'),
    [
        (lambda t: t.replace('t,u,y', 't,u,y,z'), r'line 2: the row has 3 cells, the header 4'),
        (lambda t: t.replace('t,u,y', 'u,y'), r'line 2: the row has 3 cells, the header 2'),
        (lambda t: t.replace('t,u,y', 't,u,u'), r"line 1: the name 'u' occurs 2 times"),
        (lambda t: t.replace('t,u,y', 'y,u,y'), r"line 1: the name 'y' occurs 2 times; give the number .* 1 and 3"),
        (lambda t: t.replace('0.30000,', '0.30000,7,'), r'line 32: the row has 4 cells, the header 3'),
        (lambda t: t.replace('0.30000,', '0.30000;'), r'line 32: the row has 2 cells, the header 3'),
        (lambda t: t.replace('0.30000,1.0', '0.30000,1_0').replace('0.30000,-1.0', '0.30000,1_0'),
         r"line 32: u is '1_0.*not a number"),
        (lambda t: t.replace('0.30000,', '0.30000,x'), r"line 32: u is 'x-?1\.00000', not a number"),
        (lambda _: '', 'is empty'),
        (lambda _: '\n\n \n', 'is empty'),
        (lambda _: 't,u,y\n', 'no data'),
        (lambda t: t.replace('1', '\x00', 1), 'control character'),
        (lambda t: t[:50] + '"' + t[50:], 'line '),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused_with_its_line(read, change, message):
    with pytest.raises(SatvibError, match=message):
        read(change(text_of()))


def test_mixed_decimal_signs_are_refused(read):
    """A thousand written 1.000 among decimal commas would be read as one."""
    lines = text_of(';', ',').split('\n')
    lines[11] = '0,10000;1,00000;1.000'
    with pytest.raises(SatvibError, match=r"line 12: y is '1\.000', not a number"):
        read('\n'.join(lines))


@pytest.mark.parametrize(
    ('start', 'name', 'said'),
    [
        (b'PK\x03\x04xl/workbook', 'a.xlsx', 'an Excel workbook'),
        (b'\xd0\xcf\x11\xe0', 'a.xls', 'an old Excel workbook'),
        (b'SQLite format 3\x00', 'a.db', 'an SQLite database'),
        (b'ARROW1\x00\x00', 'a.feather', 'an Arrow or Feather file'),
        (b'%PDF-1.7', 'a.pdf', 'a PDF document'),
        (b'\xef\xbb\xbf\n<!doctype html>', 'a.aspx', 'a page of HTML'),
        (b'\x89PNG\r\n', 'a.png', 'a PNG picture'),
        (b'hello', 'a.xyz', 'not a format that is known by its ending'),
    ],
)
def test_other_formats_are_named_with_what_is_readable(tmp_path, start, name, said):
    (tmp_path / name).write_bytes(start)
    with pytest.raises(
        SatvibError, match=rf'{said}.*readable are text files .* bag .* recording\.npz'
    ):
        has_columns(tmp_path / name, columns_given=False)
    if start != b'hello':
        with pytest.raises(SatvibError, match=said):
            column_record(tmp_path / name, '1', '2')


def test_the_last_line_without_an_end_is_left_out(read):
    """1.5e-05 that lost its exponent would be an outlier of 1e5 deviations."""
    table = read(text_of()[:-3])
    np.testing.assert_array_equal(table.columns[1], Y[:-1])
    assert any('may be cut' in note for note in table.notes)


def test_times_of_day_and_dates():
    """Seconds by hand."""
    assert seconds('12:00:01.5') == 43201.5
    assert seconds('01:02,5') == 62.5
    assert seconds('1970-01-02T00:00:01') == 86401.0
    assert seconds('yesterday') is None


CELL = st.text(alphabet=string.printable + 'äµ²', max_size=8)


@QUIET
@given(
    separator=st.sampled_from([',', ';', '\t', '|', ' ']),
    decimal=st.sampled_from(['.', ',']),
    encoding=st.sampled_from(['utf-8', 'utf-8-sig', 'utf-16', 'latin-1']),
    preamble=st.lists(st.text(alphabet=string.ascii_letters + ' :;/', max_size=20), max_size=5),
    units=st.booleans(),
    values=st.lists(
        st.tuples(st.floats(-1e6, 1e6, allow_nan=False), st.floats(-1e-3, 1e-3, allow_nan=False)),
        min_size=4,
        max_size=40,
    ),
)
def test_any_layout_gives_the_numbers_or_a_line(
    tmp_path_factory, separator, decimal, encoding, preamble, units, values
):
    """What is read is what was written (to 1e-12 relative); or the file is refused."""
    _layout_holds(
        tmp_path_factory.mktemp('r'), separator, decimal, encoding, preamble, units, values
    )


def _layout_holds(folder: Path, separator, decimal, encoding, preamble, units, values):
    rows = [separator.join(f'{v:.12e}'.replace('.', decimal) for v in row) for row in values]
    head = [*preamble, f'in_1{separator}out_1', *([f'V{separator}g'] if units else [])]
    path = folder / 'x.csv'
    path.write_bytes('\n'.join([*head, *rows, '']).encode(encoding, 'replace'))
    try:
        table = read_table(path, ['in_1', 'out_1'])
    except SatvibError as error:
        refusal = str(error)
    else:
        for column, written in zip(table.columns, zip(*values, strict=True), strict=True):
            np.testing.assert_allclose(column[~np.isnan(column)], written, rtol=1e-11, atol=1e-300)
        return
    assert '\n' not in refusal
    assert separator == decimal or any(preamble), refusal


@QUIET
@given(content=st.one_of(st.binary(max_size=300), CELL.map(str.encode), st.lists(CELL, max_size=30).map(
    lambda cells: ','.join(cells).encode('utf-16'))))  # fmt: skip
def test_no_file_ends_in_anything_but_columns_or_one_line(tmp_path_factory, content):
    path = tmp_path_factory.mktemp('r') / 'x.csv'
    path.write_bytes(content)
    refusals = []
    for names in (('u', 'y'), ('1', '2')):
        try:
            column_record(path, *names)
        except SatvibError as error:
            refusals.append(str(error).replace(str(path), ''))
    assert not any('\n' in refusal for refusal in refusals)
