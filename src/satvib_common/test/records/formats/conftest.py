# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One record, written in every format by a library that is not the reader's own code, or as the maker's page says."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

SAMPLES = 600
DT = 1.0 / 128.0  # s; a power of two, so that every format holds it exactly
T = DT * np.arange(SAMPLES)
U = np.where(np.random.default_rng([18, 1]).random(SAMPLES) < 0.5, -1.0, 1.0)


def _response():
    """y(k) = 1.5 y(k-1) - 0.7 y(k-2) + u(k-1) + 0.5 u(k-2) and noise, to five decimals, which every text holds."""
    noise = 0.01 * np.random.default_rng([18, 2]).standard_normal(SAMPLES)
    y = np.zeros(SAMPLES)
    for k in range(2, SAMPLES):
        y[k] = 1.5 * y[k - 1] - 0.7 * y[k - 2] + U[k - 1] + 0.5 * U[k - 2]
    return np.round(y + noise, 5)


Y = _response()
PEAK = 16.0  # m/s^2, above every |y|: full scale of the files of whole numbers


class Case(NamedTuple):
    """A file of one format.

    Attributes:
        suffix: of the file.
        write: writes it: (path) -> None.
        columns: names of input and output.
        tolerance: of the samples, of full scale; 0: every bit is the same.
        units: that a person must say; None where the file says them.
        dt_exact: whether the sample period is exact.
    """

    suffix: str
    write: Callable
    columns: tuple[str, str] = ('u', 'y')
    tolerance: float = 0.0
    units: tuple = (None, None)


def csv(path):
    rows = [
        f'{t!r},{u!r},{y!r}' for t, u, y in zip(T.tolist(), U.tolist(), Y.tolist(), strict=True)
    ]
    path.write_text('\n'.join(['t,u [V],y [m/s^2]', *rows, '']))


def mat5(path):
    from scipy.io import savemat

    savemat(path, {'t': T[:, None], 'u': U[:, None], 'y': Y, 'note': 'text'}, do_compression=True)


def mat5_struct(path):
    from scipy.io import savemat

    savemat(path, {'run': {'data': np.stack([U, Y], axis=1), 'Fs': 1.0 / DT, 'who': 'x'}})


def mat4(path):
    from scipy.io import savemat

    savemat(path, {'t': T[:, None], 'u': U[:, None], 'y': Y[:, None]}, format='4')


def mat73(path):
    """As MATLAB lays it out: 512 bytes of text first, columns as rows, the class as an attribute."""
    import h5py

    with h5py.File(path, 'w', userblock_size=512) as file:
        for name, values in (('t', T), ('u', U), ('y', Y)):
            item = file.create_dataset(name, data=values[None, :], compression='gzip')
            item.attrs['MATLAB_class'] = np.bytes_('double')
    text = b'MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Fri Nov 27 09:00:00 2026 HDF5 schema 1.00 .'
    with path.open('r+b') as file:
        file.write(text.ljust(116) + bytes(8) + b'\x00\x02IM')


def hdf5(path):
    import h5py

    with h5py.File(path, 'w') as file:
        group = file.create_group('run')
        group['t'] = T
        group.create_dataset('signals', data=np.stack([U, Y]))


def tdms(path):
    from nptdms import ChannelObject, TdmsWriter

    def channel(name, unit, values):
        about = {'wf_increment': DT, 'wf_start_offset': 0.0, 'unit_string': unit}
        return ChannelObject('Run 1', name, values, properties=about)

    with TdmsWriter(path) as writer:
        for part in (slice(0, 250), slice(250, None)):
            writer.write_segment([channel('u', 'V', U[part]), channel('y', 'm/s^2', Y[part])])


def _universal(path, binary, spacing):
    import pyuff

    file = pyuff.UFF(str(path))
    for node, kind, unit, values in ((1, 0, 'V', U), (2, 12, 'm/s^2', Y)):
        file.write_sets(
            {
                'type': 58, 'binary': binary, 'func_type': 1, 'id1': 'uy'[node - 1], 'rsp_node': node, 'rsp_dir': 3,
                'ref_node': 0, 'ref_dir': 0, 'x': T, 'data': values, 'abscissa_spacing': spacing, 'n_bytes': 0,
                'abscissa_spec_data_type': 17, 'ordinate_spec_data_type': kind, 'ordinate_axis_units_lab': unit,
                'orddenom_spec_data_type': 0, 'ord_data_type': 4,
            },
            'add',  # to overwrite loses the header of a binary set
        )  # fmt: skip


def uff(path):
    _universal(path, 0, 1)


def uff_binary(path):
    _universal(path, 1, 1)


def uff_uneven(path):
    _universal(path, 1, 0)


def _wave(path, values):
    from scipy.io import wavfile

    wavfile.write(path, round(1.0 / DT), values)


def wav(path):
    _wave(path, np.stack([U, Y], axis=1))


def wav_single(path):
    _wave(path, np.stack([U, Y], axis=1).astype(np.float32))


def wav_16(path):
    _wave(path, np.round(np.stack([U, Y], axis=1) / PEAK * 2.0**15).astype(np.int16))


def wav_32(path):
    _wave(path, np.round(np.stack([U, Y], axis=1) / PEAK * 2.0**31).astype(np.int32))


def parquet(path):
    import pyarrow as pa
    from pyarrow import parquet as pq

    fields = [
        pa.field('time', pa.duration('ns')),
        pa.field('u', pa.float64(), metadata={'unit': 'V'}),
        pa.field('y', pa.float64(), metadata={'unit': 'm/s^2'}),
    ]
    times = pa.array(np.round(T * 1e9).astype('timedelta64[ns]'))
    pq.write_table(pa.table([times, U, Y], schema=pa.schema(fields)), path)


LVM_HEAD = (
    'LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t{decimal}\n'
    'Multi_Headings\tYes\nX_Columns\t{columns}\nTime_Pref\tAbsolute\nOperator\tlab\nDate\t2026/11/27\n'
    'Time\t09:00:00,1970510124996275989\n***End_of_Header***\t\n\t\n'
)


def lvm_text(columns, decimal=',', parts=((0, SAMPLES),), unit='m/s^2'):
    """As LabVIEW writes it: 6 decimals, one header a segment; `X_Columns` is No, One or Multi."""
    multi = columns == 'Multi'

    def cells(first, u, y):
        return '\t'.join([first, u, *([''] if multi else []), y])

    text = LVM_HEAD.format(decimal=decimal, columns=columns)
    for begin, end in parts:
        n = str(end - begin)
        delta = f'{DT:.6E}'.replace('.', decimal)
        for key, u, y in (
            ('Channels', '2', ''), ('Samples', n, n), ('Date', '2026/11/27', '2026/11/27'),
            ('Y_Unit_Label', 'Volts', unit), ('X_Dimension', 'Time', 'Time'),
            ('X0', f'{T[begin]:.16E}'.replace('.', decimal), f'{T[begin]:.16E}'.replace('.', decimal)),
            ('Delta_X', delta, delta), ('***End_of_Header***', '', ''),
        ):  # fmt: skip
            text += cells(key, u, y) + '\t\n'
        text += '\t'.join(['X_Value', 'u', *(['X_Value'] if multi else []), 'y', 'Comment']) + '\n'
        for k in range(begin, end):
            t, u, y = (f'{v:.7f}'.replace('.', decimal) for v in (T[k], U[k], Y[k]))
            row = {'No': ['', u, y], 'One': [t, u, y], 'Multi': [t, u, t, y]}[columns]
            text += '\t'.join(row) + '\n'
        text += '\n'
    return text


def _lvm(columns, decimal=','):
    return lambda path: path.write_text(lvm_text(columns, decimal), newline='\r\n')


CASES = {
    'csv': Case('.csv', csv),
    'mat5': Case('.mat', mat5),
    'mat5_struct': Case('.mat', mat5_struct, ('run.data:1', 'run.data:2')),
    'mat4': Case('.mat', mat4),
    'mat73': Case('.mat', mat73),
    'hdf5': Case('.h5', hdf5, ('run/signals:1', 'run/signals:2')),
    'tdms': Case('.tdms', tdms),
    'uff': Case('.uff', uff),
    'uff_binary': Case('.unv', uff_binary),
    'uff_uneven': Case('.unv', uff_uneven),
    'wav': Case('.wav', wav, ('1', '2')),
    'wav_single': Case('.wav', wav_single, ('1', '2'), 2.0**-24),
    'wav_16': Case('.wav', wav_16, ('1', '2'), 2.0**-16, (f'{PEAK} V', f'{PEAK} m/s^2')),
    'wav_32': Case('.wav', wav_32, ('1', '2'), 2.0**-32, (f'{PEAK} V', f'{PEAK} m/s^2')),
    'parquet': Case('.parquet', parquet),
    'lvm_no': Case('.lvm', _lvm('No')),
    'lvm_one': Case('.lvm', _lvm('One', '.')),
    'lvm_multi': Case('.lvm', _lvm('Multi')),
}


@pytest.fixture(params=[name for name in CASES if name != 'csv'])
def case(request):
    """Each format in turn."""
    return CASES[request.param]


@pytest.fixture
def written(tmp_path, case):
    """The file of a format."""
    path = tmp_path / f'record{case.suffix}'
    case.write(path)
    return path


@pytest.fixture
def csv_file(tmp_path):
    """The same record as a text."""
    path = tmp_path / 'record.csv'
    csv(path)
    return path


@pytest.fixture(scope='session')
def cases():
    """All formats by name."""
    return {name: case for name, case in CASES.items() if name != 'csv'}


@pytest.fixture(scope='session')
def lvm():
    """Text of a LabVIEW file: lvm(columns, decimal, parts, unit)."""
    return lvm_text
