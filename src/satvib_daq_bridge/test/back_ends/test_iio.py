# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The iio back end: the real libiio, over its network protocol, against a small server of that protocol in the test.

Truth: what the server was asked and what it was told to answer. The protocol is that of iiod 0.24: lines of text, each
answered by a length or an error number and, where it reads, that many bytes.
"""

import math
import socket
import sys
import threading

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_daq_bridge.back_ends.base import BackEndError
from satvib_daq_bridge.back_ends.factory import make_back_end
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.simulated.channels_from_rig import channels_of
from satvib_plant_sim.rig.rig import load_rig

PERIOD = 0.01
IN_SCALE, OUT_SCALE = 10000.0 / 4096, 20000.0 / 4096  # mV a count: 12 bit of +-5 V and of +-10 V

DTD = (
    '<!DOCTYPE context [<!ELEMENT context (device)*><!ELEMENT device (channel)*>'
    '<!ELEMENT channel (attribute*)><!ELEMENT attribute EMPTY>'
    '<!ATTLIST context name CDATA #REQUIRED description CDATA #IMPLIED>'
    '<!ATTLIST device id CDATA #REQUIRED name CDATA #IMPLIED>'
    '<!ATTLIST channel id CDATA #REQUIRED type (input|output) #REQUIRED>'
    '<!ATTLIST attribute name CDATA #REQUIRED filename CDATA #IMPLIED>]>'
)


def needs_libiio():
    try:
        import iio  # noqa: F401
    except ImportError:
        pytest.skip("pylibiio is missing: pip install 'pylibiio<1'")
    except (OSError, AttributeError, TypeError):
        pytest.skip('libiio is missing: apt install libiio0')


def channel_xml(index, kind, attributes):
    inner = ''.join(
        f'<attribute name="{a}" filename="{kind}_voltage{index}_{a}"/>' for a in attributes
    )
    return f'<channel id="voltage{index}" type="{kind}">{inner}</channel>'


class Server:
    """An iiod with an ADC of six inputs with an offset, and a DAC of three outputs."""

    def __init__(self):
        self.socket = socket.create_server(('127.0.0.1', 0))
        self.uri = f'ip:127.0.0.1:{self.socket.getsockname()[1]}'
        self.values = {('adc', f'voltage{i}', 'raw'): '1024' for i in range(6)}
        self.values |= {('adc', f'voltage{i}', 'scale'): str(IN_SCALE) for i in range(6)}
        self.values |= {('adc', f'voltage{i}', 'offset'): '-2048' for i in range(6)}
        self.values |= {('dac', f'voltage{i}', 'raw'): '1500' for i in range(3)}
        self.values |= {('dac', f'voltage{i}', 'scale'): str(OUT_SCALE) for i in range(3)}
        self.failing, self.asked = {}, []
        self.answering = threading.Event()
        self.answering.set()
        self.ids = {'iio:device0': 'adc', 'iio:device1': 'dac'}
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def xml(self):
        adc = ''.join(channel_xml(i, 'input', ('raw', 'scale', 'offset')) for i in range(6))
        dac = ''.join(channel_xml(i, 'output', ('raw', 'scale')) for i in range(3))
        return (
            f'<?xml version="1.0" encoding="utf-8"?>{DTD}<context name="network">'
            f'<device id="iio:device0" name="adc">{adc}</device>'
            f'<device id="iio:device1" name="dac">{dac}</device></context>'
        )

    def _accept(self):
        while True:
            try:
                line, _ = self.socket.accept()
            except OSError:
                return
            threading.Thread(target=self._serve, args=(line,), daemon=True).start()

    def _serve(self, line):
        with line, line.makefile('rb') as source:
            while (words := source.readline().decode().split()) and words[0] != 'EXIT':
                data = source.read(int(words[5])) if words[0] == 'WRITE' else b''
                self.answering.wait(10)
                line.sendall(self._answer(words, data))

    def _answer(self, words, data):
        if words[0] == 'VERSION':
            return b'0.24.0000000\n'
        if words[0] == 'PRINT':
            return f'{len(self.xml)}\n{self.xml}\n'.encode()
        if words[0] == 'TIMEOUT':
            return b'0\n'
        key = (self.ids.get(words[1], words[1]), words[3], words[4])
        self.asked.append((words[0], *key))
        if key in self.failing:
            return f'{-self.failing[key]}\n'.encode()
        if words[0] == 'READ':
            value = self.values[key].encode() + b'\0'
            return b'%d\n%s\n' % (len(value), value)
        self.values[key] = data.rstrip(b'\0').decode()
        return b'%d\n' % len(data)

    def out(self, i):
        return int(self.values['dac', f'voltage{i}', 'raw'])


@pytest.fixture
def server():
    needs_libiio()
    made = Server()
    yield made
    made.answering.set()
    made.socket.close()


def data_of(server, sensor=(), coil=(), **options):
    sensor = {'device': 'adc', **dict(sensor)}
    options = {'uri': server.uri, **options} if server else options
    coil = {'device': 'dac', **dict(coil)}
    return channels_of(load_rig('paper_3dof'), 'iio', 'x', options, sensor, coil)


def devices_of(data):
    return make_back_end(parse_channels(data, 'test'), PERIOD, 0.03)


@pytest.fixture
def devices(server):
    made = devices_of(data_of(server))
    made.open()
    yield made
    made.close()


def test_outputs_are_at_0_v_before_an_input_is_found(devices, server):
    del devices
    assert [server.out(i) for i in range(3)] == [0, 0, 0]
    written = [i for i, (what, *_) in enumerate(server.asked) if what == 'WRITE']
    inputs = [i for i, (_, device, *_) in enumerate(server.asked) if device == 'adc']
    assert max(written) < min(inputs)


def test_counts_become_volts_and_volts_counts(devices, server):
    """Truth: (raw + offset) scale; 1024 - 2048 counts of 2.44 mV are -2.5 V. 1 V is 204.8 counts of 4.88 mV: 205."""
    for i in range(6):
        server.values['adc', f'voltage{i}', 'raw'] = str(1024 + 100 * i)
    devices.start(0.0)
    (reading,) = devices.poll(PERIOD)
    expected = [(1024 + 100 * i - 2048) * IN_SCALE / 1e3 for i in range(6)]
    np.testing.assert_allclose(reading.volts, expected, rtol=1e-12)
    devices.write(np.array([1.0, -1.0, 9.99]), 0, True, 0.0)
    assert [server.out(i) for i in range(3)] == [
        205,
        -205,
        math.floor(9.99 / OUT_SCALE * 1e3 + 0.5),
    ]
    devices.zero()
    assert [server.out(i) for i in range(3)] == [0, 0, 0]


def test_an_error_of_the_device_is_reported(devices, server):
    """Truth: errno 5 from the server is EIO."""
    devices.start(0.0)
    server.failing['adc', 'voltage3', 'raw'] = 5
    with pytest.raises(BackEndError, match=r'iio: strut_1\.lower: read: Input/output error'):
        devices.poll(PERIOD)
    server.failing['dac', 'voltage0', 'raw'] = 16
    with pytest.raises(BackEndError, match=r'iio: strut_1\.coil: write: Device or resource busy'):
        devices.write(np.array([1.0, 1.0, 1.0]), 0, True, 0.0)
    assert server.out(2) == 205, 'the others are written'
    devices.zero()  # never raises
    assert server.out(2) == 0


def test_a_network_that_hangs_is_an_error_within_its_patience(server):
    made = devices_of(data_of(server, patience=0.2))
    made.open()
    made.start(0.0)
    server.answering.clear()
    with pytest.raises(BackEndError, match='read: '):
        made.poll(PERIOD)
    server.answering.set()


@pytest.mark.parametrize(
    ('changes', 'message'),
    [
        ({'sensor': {'device': 'ad7606'}}, r'strut_1\.upper: no IIO device ad7606 \(devices: adc, dac\)'),
        ({'coil': {'device': 'adc'}}, r'strut_1\.coil: adc has no output voltage0'),
        ({'coil': {'bits': 16}}, r'strut_1\.coil: bits: .* the device says 0\.0048'),
    ],
)  # fmt: skip
def test_what_the_device_does_not_have_is_refused_by_name(server, changes, message):
    made = devices_of(data_of(server, **changes))
    with pytest.raises(SatvibError, match=message):
        made.open()


def test_nobody_there_is_said_in_one_line():
    needs_libiio()
    with socket.create_server(('127.0.0.1', 0)) as free:
        uri = f'ip:127.0.0.1:{free.getsockname()[1]}'
    made = devices_of(data_of(None, uri=uri))
    with pytest.raises(SatvibError, match=r'iio: ip:127\.0\.0\.1:\d+: .*; is the device there'):
        made.open()


def test_missing_bindings_name_the_command(monkeypatch):
    monkeypatch.setitem(sys.modules, 'iio', None)
    with pytest.raises(SatvibError, match="install it with: pip install 'pylibiio<1'"):
        devices_of(data_of(None))
