# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The comedi back end: the real library without a device, and every call against a stub library built here.

Truth: the stub's codes; 12 bit over +-5 V and +-10 V as comedi_to_phys and comedi_from_phys define them.
"""

import ctypes
import ctypes.util
import math
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml
from satvib_daq_bridge.back_ends.base import BackEndError
from satvib_daq_bridge.back_ends.factory import make_back_end
from satvib_daq_bridge.channels import parse_channels

import satvib_daq_bridge

CONFIG = Path(satvib_daq_bridge.__file__).parent / 'config'
COMPILER = shutil.which('gcc') or shutil.which('cc')
PERIOD = 0.01


def channels_of(library, **options):
    """The shipped channels file of the paper's boards."""
    data = load_yaml(CONFIG / 'comedi_3dof.yaml')
    data['options'] = {'library': str(library), **options} if library else options
    return data


@pytest.fixture(scope='module')
def library(tmp_path_factory):
    if not COMPILER:
        pytest.skip('a C compiler is missing: apt install gcc')
    path = tmp_path_factory.mktemp('comedi') / 'libcomedi.so'
    source = Path(__file__).parent / 'comedi' / 'stub.c'
    subprocess.run(
        [COMPILER, '-shared', '-fPIC', '-Wall', '-Werror', '-o', path, source], check=True
    )
    return path


@pytest.fixture
def stub(library):
    loaded = ctypes.CDLL(str(library))
    loaded.stub_calls.restype = ctypes.c_char_p
    loaded.stub_output.restype = ctypes.c_uint
    loaded.stub_reset()
    return loaded


@pytest.fixture
def boards(library, stub):
    made = make_back_end(parse_channels(channels_of(library), 'test'), PERIOD, 0.03)
    made.open()
    yield made
    made.close()
    assert [stub.stub_open(b) for b in (0, 1)] == [0, 0]


def calls(stub):
    return stub.stub_calls().decode().split(';')[:-1]


def test_open_locks_the_outputs_and_writes_0_v_before_anything_is_read(boards, stub):
    """Truth: 0 V is code 2047.5 of 4095 over +-10 V, rounded to 2048. A killed writer had left code 3500, 7.1 V."""
    del boards
    said = calls(stub)
    assert said[:2] == ['open /dev/comedi0', 'open /dev/comedi1']
    assert said[2:4] == ['lock', 'lock']
    assert said[4:] == ['write 0 1 0 0 0 2048', 'write 0 1 1 0 0 2048', 'write 1 1 0 0 0 2048']
    assert [stub.stub_output(0, 0), stub.stub_output(0, 1), stub.stub_output(1, 0)] == [2048] * 3
    assert (stub.stub_locked(0), stub.stub_locked(1), stub.stub_oor()) == (1, 1, 1)


def test_inputs_are_read_in_order_with_their_range_and_reference(boards, stub):
    codes = [0, 1024, 2048, 3072, 4095, 1]
    for i, code in enumerate(codes):
        stub.stub_input(0, i, code)
    boards.start(0.0)
    (reading,) = boards.poll(PERIOD)
    expected = [-5.0 + 10.0 * code / 4095 for code in codes]
    np.testing.assert_allclose(reading.volts, expected, rtol=1e-12)
    assert calls(stub)[-6:] == [f'read 0 {i} 1 0' for i in range(6)]


def test_outputs_go_to_their_board(boards, stub):
    boards.write(np.array([10.0, -10.0, 5.0]), 0, True, 0.0)
    assert [stub.stub_output(0, 0), stub.stub_output(0, 1)] == [4095, 0]
    assert stub.stub_output(1, 0) == math.floor(15.0 / 20.0 * 4095 + 0.5)
    assert stub.stub_output(1, 1) == 3500, 'a channel that is not ours is left alone'
    boards.zero()
    assert [stub.stub_output(0, 0), stub.stub_output(0, 1), stub.stub_output(1, 0)] == [2048] * 3


def test_the_reference_is_an_option(library, stub):
    data = channels_of(library, reference='diff')
    made = make_back_end(parse_channels(data, 'test'), PERIOD, 0.03)
    made.open()
    made.start(0.0)
    made.poll(PERIOD)
    assert calls(stub)[-1] == 'read 0 5 1 2'
    made.close()


def test_the_host_keeps_the_time_and_tells_what_it_lost(boards):
    """Truth: ticks at whole periods; a stall of 3.5 periods loses three."""
    boards.start(0.0)
    assert boards.poll(0.5 * PERIOD) == []
    assert boards.due() == PERIOD
    assert [r.sequence for r in boards.poll(1.1 * PERIOD)] == [0]
    assert boards.poll(1.9 * PERIOD) == []
    assert [r.sequence for r in boards.poll(5.5 * PERIOD)] == [4]
    assert boards.figures() == {'samples lost': 3.0}


def test_a_read_that_fails_is_a_back_end_error(boards, stub):
    boards.start(0.0)
    stub.stub_fail(b'comedi_data_read')
    with pytest.raises(BackEndError, match=r'strut_1\.upper: comedi_data_read: Input/output error'):
        boards.poll(PERIOD)
    stub.stub_fail(b'')


def test_a_write_that_fails_is_told_and_the_other_outputs_are_written(boards, stub):
    stub.stub_fail(b'comedi_data_write')
    with pytest.raises(BackEndError, match=r'strut_1\.coil: comedi_data_write: Input/output error'):
        boards.write(np.array([1.0, 10.0, -10.0]), 0, True, 0.0)
    assert stub.stub_output(0, 1) == 4095
    boards.zero()  # never raises
    stub.stub_fail(b'')


def test_outputs_in_use_are_refused(library, stub):
    stub.stub_fail(b'comedi_lock')
    made = make_back_end(parse_channels(channels_of(library), 'test'), PERIOD, 0.03)
    with pytest.raises(SatvibError, match='comedi_lock: Device or resource busy'):
        made.open()
    made.close()


@pytest.mark.parametrize(
    ('path', 'value', 'message'),
    [
        (('strut_3', 'coil', 'device'), '/dev/comedi7', '/dev/comedi7: comedi_open: No such file'),
        (('strut_3', 'coil', 'index'), 2, r'strut_3\.coil: /dev/comedi1 has 2 analog outputs'),
        (('strut_2', 'upper', 'index'), 16, r'strut_2\.upper: /dev/comedi0 has 16 analog inputs'),
        (('strut_1', 'upper', 'range'), [-4.0, 4.0], r'strut_1\.upper: .* no range of -4 to 4 V'),
        (('strut_1', 'coil', 'bits'), 16, r'strut_1\.coil: bits: 16, but .* codes from 0 to 4095'),
    ],
)
def test_what_the_board_does_not_have_is_refused_by_name(library, stub, path, value, message):
    data = channels_of(library)
    strut, part, key = path
    data['struts'][strut][part][key] = value
    made = make_back_end(parse_channels(data, 'test'), PERIOD, 0.03)
    with pytest.raises(SatvibError, match=message):
        made.open()
    made.close()
    assert stub.stub_open(0) == 0


def test_a_missing_library_names_its_package():
    with pytest.raises(SatvibError, match=r'back end comedi: /none\.so is missing; .* apt install'):
        make_back_end(parse_channels(channels_of('/none.so'), 'test'), PERIOD, 0.03)


def test_the_real_library_without_a_device():
    """Truth: there is no /dev/comedi0 on this machine; the real libcomedi says so."""
    if not ctypes.util.find_library('comedi'):
        pytest.skip('libcomedi is missing: apt install libcomedi0')
    if Path('/dev/comedi0').exists():
        pytest.skip('there is a comedi device on this machine')
    made = make_back_end(parse_channels(channels_of(''), 'test'), PERIOD, 0.03)
    with pytest.raises(SatvibError, match=r'/dev/comedi0: comedi_open: \w+.*; is the board there'):
        made.open()
    made.zero()
    made.close()
