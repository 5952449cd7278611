# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is in the files of each format: groups, structures, units, times, several segments, what cannot be read.

Truth: the arrays that were written.
"""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.records.any_file import has_columns, list_columns, read_table
from satvib_common.records.record import column_record

N = 64
A = np.round(np.random.default_rng([18, 4]).standard_normal(N), 5)
B = np.round(np.random.default_rng([18, 5]).standard_normal(N), 5)


def refused(path, *columns, **options):
    with pytest.raises(SatvibError) as caught:
        column_record(path, *columns, **options)
    line = str(caught.value)
    assert line.startswith(f'{path}: ')
    assert '\n' not in line
    return line


@pytest.fixture
def mat(tmp_path):
    """Write variables to a MATLAB file: mat(**variables) -> path."""
    from scipy.io import savemat

    def run(**variables):
        savemat(tmp_path / 'x.mat', variables)
        return tmp_path / 'x.mat'

    return run


def test_structures_and_matrices_of_matlab(mat):
    path = mat(run={'in': A, 'acc': np.stack([B, 2 * B, 3 * B]), 'dt': 0.5}, other={'in': B})
    record = column_record(path, 'run.in', 'acc:2')
    np.testing.assert_array_equal(record.u, A)
    np.testing.assert_array_equal(record.y, 2 * B)
    assert record.dt == 0.5
    assert "sample period 0.5 s from 'run.dt'" in record.notes
    assert "the name 'in' occurs 2 times; give 'run.in' or 'other.in'" in refused(
        path, 'in', 'acc:2'
    )
    assert 'no channel 9; there are 5: 1 run.in (64), 2 run.acc:1 (64)' in refused(path, '9', '1')
    np.testing.assert_array_equal(column_record(path, '1', '3').y, 2 * B)


@pytest.mark.parametrize(('name', 'what'), [('fs', 'rate'), ('dt', 'period')])
@pytest.mark.parametrize('value', [0.0, -200.0, np.nan, np.inf])
def test_what_is_no_sample_rate_is_refused(mat, name, what, value):
    """Truth: a rate is above zero. A period that is given stands above the file."""
    path = mat(**{'u': A, 'y': B, name: value})
    assert f'{name} = {value:.6g} is no sample {what}; give --sample-period' in refused(
        path, 'u', 'y'
    )
    assert column_record(path, 'u', 'y', 0.5).dt == 0.5


def test_structure_arrays_and_cells_of_matlab(mat):
    signals = np.zeros((2,), dtype=[('Name', 'O'), ('Data', 'O')])
    signals[0], signals[1] = ('u', A), ('y', B)
    cells = np.empty(2, dtype=object)
    cells[:] = [A, B]
    path = mat(Y=signals, c=cells)
    np.testing.assert_array_equal(column_record(path, 'Y:1.Data', 'Y:2.Data').y, B)
    np.testing.assert_array_equal(column_record(path, 'c:1', 'c:2').y, B)


def test_what_matlab_files_hold_besides_numbers_is_named(mat):
    from scipy.sparse import eye_array

    path = mat(
        u=A, y=B, z=A + 1j * B, s=eye_array(N), cube=np.ones((3, 4, 5)), long=np.ones(7),
        text='abc', fs=200.0, run={'what': 'abc', 'level': 2.0},
    )  # fmt: skip
    assert 'z holds complex128, not numbers' in refused(path, 'u', 'z')
    assert 's: a sparse matrix' in refused(path, 'u', 's')
    assert 'cube: an array of 3 dimensions' in refused(path, 'u', 'cube')
    assert 'u and long do not belong together: 64 and 7 samples' in refused(path, 'u', 'long')
    assert '--time: long has 7 samples, u has 64' in refused(path, 'u', 'y', time='long')
    for name in ('text', 'run.what', 'what'):
        assert f'{name} holds text, not a record of numbers' in refused(path, 'u', name)
    for name in ('fs', 'run.level', 'level'):
        assert f'{name} is a single number, not a record of numbers' in refused(path, name, 'y')


def test_a_file_without_numbers_is_no_record(mat):
    assert 'is a MATLAB file without any column of numbers' in refused(mat(who='x'), None, None)


def test_a_table_of_matlab_is_named_with_the_way_out(tmp_path):
    """Written as MATLAB 7.3 marks an object; its contents are not published."""
    import h5py

    with h5py.File(tmp_path / 'x.mat', 'w') as file:
        item = file.create_dataset('T', data=np.zeros((1, 6), dtype=np.uint32))
        item.attrs['MATLAB_class'] = np.bytes_('table')
        item.attrs['MATLAB_object_decode'] = np.int32(3)
    line = refused(tmp_path / 'x.mat', 'T', '1')
    assert "save its columns as arrays, as in s = table2struct(T, 'ToScalar', true)" in line


def test_structure_arrays_of_matlab_73_are_references(tmp_path):
    """As MATLAB writes a structure array: a group whose fields are data sets of references into #refs#."""
    import h5py

    path = tmp_path / 'x.mat'
    with h5py.File(path, 'w') as file:
        group = file.create_group('Y')
        group.attrs['MATLAB_class'] = np.bytes_('struct')
        inner = file.create_group('#refs#')
        inner['a'], inner['b'] = A[None, :], B[None, :]
        field = group.create_dataset('Data', (2, 1), dtype=h5py.ref_dtype)
        field[0, 0], field[1, 0] = inner['a'].ref, inner['b'].ref
    record = column_record(path, 'Y:1.Data', 'Y:2.Data')
    np.testing.assert_array_equal(record.u, A)
    np.testing.assert_array_equal(record.y, B)


def test_a_group_that_holds_itself_ends(tmp_path):
    import h5py

    with h5py.File(tmp_path / 'x.h5', 'w') as file:
        file['u'], file['y'] = A, B
        group = file.create_group('loop')
        group['again'] = group
        file['elsewhere'] = h5py.ExternalLink('other.h5', '/')
        file['who'] = ['a', 'b', 'c']
        file['old'] = np.array([b'a', b'b'])
        file['mat'] = np.array([97, 98], dtype=np.uint16)
        file['mat'].attrs['MATLAB_class'] = np.bytes_('char')
    for name in ('who', 'old', 'mat'):
        assert f'{name} holds text' in refused(tmp_path / 'x.h5', 'u', name)
    assert list_columns(tmp_path / 'x.h5') == '1 u (64), 2 y (64)'


def test_groups_of_tdms(tmp_path):
    from nptdms import ChannelObject, TdmsWriter

    path = tmp_path / 'x.tdms'
    about = {'wf_increment': 0.25, 'unit_string': 'g'}
    with TdmsWriter(path) as writer:
        writer.write_segment([
            ChannelObject('Run 1', 'acc', A, properties=about), ChannelObject('Run 2', 'acc', B, properties=about),
            ChannelObject('Run 2', 'coil', B), ChannelObject('Run 1', 'who', ['x', 'y']),
            ChannelObject('Run 1', 'late', A, properties={'wf_increment': 0.25, 'wf_start_offset': 3.0}),
            ChannelObject('Run 1', 'also', B, properties={'wf_increment': 0.25, 'wf_start_offset': 3.0}),
        ])  # fmt: skip
    assert "the name 'acc' occurs 2 times; give 'Run 1/acc' or 'Run 2/acc'" in refused(
        path, 'coil', 'acc'
    )
    assert 'Run 1/who: holds no numbers' in refused(path, 'coil', 'who')
    assert 'sample periods 0 and 0.25 s' in refused(path, 'coil', 'Run 2/acc')
    assert 'they begin 3 s apart' in refused(path, 'Run 1/acc', 'late')
    record = column_record(path, 'late', 'also', units=('V', 'g'))
    assert record.dt == 0.25
    line = refused(path, None, None)
    assert 'there are 1 Run 1/acc [g] (64)' in line
    assert 'who (holds no numbers)' in line


def test_units_of_the_file_are_converted(tmp_path):
    from nptdms import ChannelObject, TdmsWriter

    path = tmp_path / 'x.tdms'
    with TdmsWriter(path) as writer:
        writer.write_segment([
            ChannelObject('r', 'u', A, properties={'unit_string': 'mV'}),
            ChannelObject('r', 'y', B, properties={'unit_string': 'g'}),
            ChannelObject('r', 'f', B, properties={'unit_string': 'N'}),
        ])  # fmt: skip
    record = column_record(path, 'u', 'y')
    np.testing.assert_array_equal(record.u, A * 1e-3)
    np.testing.assert_array_equal(record.y, B * 9.80665)
    assert 'output: converted from g to m/s^2' in record.notes
    told = column_record(path, 'u', 'y', units=('2 V', 'm/s^2'))
    np.testing.assert_array_equal(told.u, A * 2.0)
    np.testing.assert_array_equal(told.y, B)
    force = column_record(path, 'f', 'y')
    np.testing.assert_array_equal(force.u, B)
    assert 'input: is in N, which is no voltage; taken as it is' in force.notes


def test_universal_files_name_what_is_no_time_record(tmp_path):
    import pyuff

    path = tmp_path / 'x.uff'
    file = pyuff.UFF(str(path))
    common = {
        'type': 58, 'binary': 0, 'rsp_node': 5, 'rsp_dir': -1, 'ref_node': 0, 'ref_dir': 0, 'abscissa_spacing': 1,
        'x': 0.5 * np.arange(N), 'orddenom_spec_data_type': 0, 'ord_data_type': 4,
    }  # fmt: skip
    file.write_sets({**common, 'func_type': 1, 'data': A.copy(), 'id1': 'coil'}, 'overwrite')
    file.write_sets({**common, 'func_type': 4, 'data': A + 1j * B, 'id1': 'frf'}, 'add')
    file.write_sets(
        {**common, 'func_type': 1, 'data': B.copy(), 'id1': 'NONE', 'rsp_node': 6}, 'add'
    )
    assert 'frf: a frequency response, not a time record' in refused(path, 'coil', 'frf')
    record = column_record(path, 'coil', '6-X')
    assert record.dt == 0.5
    np.testing.assert_array_equal(record.u, A)
    np.testing.assert_array_equal(record.y, B)
    text = path.read_bytes()
    path.write_bytes(text.replace(b'        64', b'        63', 1))
    assert 'data set 1 has 64 values' not in refused(path, 'coil', 'frf')
    path.write_bytes(text[: text.rindex(b'    -1')])
    assert 'data set 3 has no end: the file is cut' in refused(path, 'coil', '6-X')


def test_times_and_missing_values_of_parquet(tmp_path):
    import pyarrow as pa
    from pyarrow import parquet as pq

    path = tmp_path / 'x.parquet'
    stamps = np.datetime64('2026-11-27T09:00:00', 'ns') + np.arange(N) * np.timedelta64(2, 'ms')
    whole = [None if k == 9 else k % 5 for k in range(N)]
    pq.write_table(
        pa.table(
            {'Timestamp': stamps, 'u [mV]': pa.array(whole, pa.int32()), 'y': B, 'who': ['x'] * N}
        ),
        path,
    )
    record = column_record(path, 'u', 'y')
    assert record.dt == pytest.approx(0.002, rel=1e-9)
    assert np.flatnonzero(np.isnan(record.u)).tolist() == [9]
    assert record.u[8] == pytest.approx(3e-3)
    assert any(
        '1 samples lack a value (1.6 %, first at sample 10)' in note for note in record.notes
    )
    assert 'who: holds string, not numbers' in refused(path, 'who', 'y')


def test_segments_of_labview_follow_each_other(tmp_path, lvm):
    """Where the times go on, one record; where they begin again, records of their own."""
    path = tmp_path / 'x.lvm'
    path.write_text(lvm('One', parts=((0, 200), (200, 600))))
    assert np.isfinite(column_record(path, 'u', 'y').y).all()
    path.write_text(lvm('No', parts=((0, 200), (0, 200))))
    record = column_record(path, 'u', 'y', memory=30)
    assert len(record.y) == 430
    assert np.flatnonzero(np.isnan(record.y)).tolist() == list(range(200, 230))


def test_labview_units_and_what_is_not_over_time(tmp_path, lvm):
    path = tmp_path / 'x.lvm'
    path.write_text(lvm('Multi', '.', unit='g'))
    record = column_record(path, 'u', 'y')
    assert record.notes[-1] == 'output: converted from g to m/s^2'
    assert record.y[10] == 9.80665 * read_table(path, ['y']).columns[0][10]
    path.write_text(
        lvm('No').replace('X_Dimension\tTime\tTime', 'X_Dimension\tFrequency\tFrequency')
    )
    assert 'u is over Frequency, not over time' in refused(path, 'u', 'y')
    path.write_text(lvm('No').split('***End')[0])
    assert 'it is cut in its header' in refused(path, 'u', 'y')


@pytest.mark.parametrize(
    ('header', 'units', 'factors'),
    [
        ('t,u [mV],y [g]', '', (1e-3, 9.80665)),
        ('t,u (mV),y (m/s²)', '', (1e-3, 1.0)),
        ('t,u / V,y / (mm/s^2)', '', (1.0, 1e-3)),
        ('t,u,y', 's,mV,m/s2\n', (1e-3, 1.0)),
        ('t,u,y', '[s],[V],[g]\n', (1.0, 9.80665)),
        ('t,u (Trigger),y', '', (1.0, 1.0)),
    ],
)
def test_units_of_a_text(tmp_path, header, units, factors):
    """The name may be given with its unit or without."""
    rows = ''.join(
        f'{k},{a!r},{b!r}\n' for k, (a, b) in enumerate(zip(A.tolist(), B.tolist(), strict=True))
    )
    (tmp_path / 'x.csv').write_text(f'{header}\n{units}{rows}')
    u, y = header.split(',')[1:]
    for names in ((u, y), (u.split(' ')[0] if 'Trigger' not in u else u, y.split(' ')[0])):
        record = column_record(tmp_path / 'x.csv', *names)
        np.testing.assert_array_equal(record.u, A * factors[0])
        np.testing.assert_array_equal(record.y, B * factors[1])


def test_a_text_without_names_lists_what_there_is(tmp_path):
    (tmp_path / 'x.csv').write_text('time (ms),coil,acc\nms,V,g\n' + '1,2,3\n' * 9)
    assert list_columns(tmp_path / 'x.csv') == '1 time (ms), 2 coil, 3 acc'
    (tmp_path / 'x.csv').write_text('1,2,3\n' * 9)
    assert 'the file has no header line' in refused(tmp_path / 'x.csv', None, None)


def test_a_column_is_no_response_to_itself(written, case):
    """In every format. Truth: the name that was given twice."""
    u, y = case.columns
    line = refused(written, u, u)
    assert f'column {u!r} is named twice; input, output and time differ' in line
    if case.suffix != '.lvm':  # whose times stand before each channel
        assert f'column {y!r} is named twice' in refused(written, u, y, time=y)


def test_a_number_and_a_name_of_one_column_are_the_same(mat, tmp_path):
    """Truth: the order in which the columns were written."""
    text = tmp_path / 'x.csv'
    text.write_text('t,u [V],u,y\n' + ''.join(f'{i},{i},{i},{i}\n' for i in range(9)))
    assert "column 'y' and '4' are one" in refused(text, 'y', '4')
    assert "column '1' and 't' are one" in refused(text, '1', 'y', time='t')
    assert "column 'u' and '1' are one" in refused(mat(u=A, y=B), 'u', '1')
    assert column_record(text, '2', '3').u.size == 9  # two columns of one name are two


def test_which_files_have_columns(tmp_path, written):
    assert has_columns(written, columns_given=False)
    assert not has_columns(tmp_path, columns_given=True)
