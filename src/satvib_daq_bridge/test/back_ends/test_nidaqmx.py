# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The nidaqmx back end: the real client of NI against a server that the test builds on the stubs of NI's package.

Truth: what the server was asked and what it was told to answer.
"""

import sys
import threading
from concurrent import futures

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_daq_bridge.back_ends.base import BackEndError
from satvib_daq_bridge.back_ends.factory import make_back_end
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.simulated.channels_from_rig import channels_of
from satvib_plant_sim.rig.rig import load_rig

INSTALL = "nidaqmx with gRPC is missing: pip install 'nidaqmx[grpc]'"
nidaqmx = pytest.importorskip('nidaqmx', reason=INSTALL)
grpc = pytest.importorskip('grpc', reason=INSTALL)
stubs = pytest.importorskip('nidaqmx._stubs.nidaqmx_pb2', reason=INSTALL)
services = pytest.importorskip('nidaqmx._stubs.nidaqmx_pb2_grpc', reason=INSTALL)
session = pytest.importorskip('session_pb2', reason=INSTALL)

PERIOD = 0.01
CHANNEL_NAMES = 0x1273


class Server(services.NiDAQmxServicer):
    """Tasks, channels and values in memory."""

    def __init__(self):
        self.tasks, self.calls, self.inputs, self.outputs = {}, [], {}, {}
        self.failing = {}
        self.stall = threading.Event()
        self.stall.set()

    def _begin(self, name, context, *said):
        self.calls.append((name, *said))
        self.stall.wait(10)
        if name in self.failing:
            code, text = self.failing[name]
            context.set_trailing_metadata((('ni-error', str(code)),))
            context.abort(grpc.StatusCode.UNKNOWN, text)

    def CreateTask(self, request, context):  # noqa: N802
        self._begin('CreateTask', context, request.session_name)
        new = request.session_name not in self.tasks
        self.tasks.setdefault(request.session_name, [])
        return stubs.CreateTaskResponse(
            status=0, task=session.Session(name=request.session_name), new_session_initialized=new
        )

    def _add(self, kind, request, context):
        self._begin(kind, context, request.physical_channel, request.min_val, request.max_val)
        self.tasks[request.task.name].append(request.physical_channel)

    def CreateAIVoltageChan(self, request, context):  # noqa: N802
        self._add('CreateAIVoltageChan', request, context)
        return stubs.CreateAIVoltageChanResponse(status=0)

    def CreateAOVoltageChan(self, request, context):  # noqa: N802
        self._add('CreateAOVoltageChan', request, context)
        return stubs.CreateAOVoltageChanResponse(status=0)

    def GetTaskAttributeString(self, request, context):  # noqa: N802
        self._begin('GetTaskAttributeString', context)
        channels = request.attribute_raw == CHANNEL_NAMES
        value = ', '.join(self.tasks[request.task.name]) if channels else request.task.name
        return stubs.GetTaskAttributeStringResponse(status=0, value=value)

    def GetSystemInfoAttributeUInt32(self, request, context):  # noqa: ARG002, N802
        return stubs.GetSystemInfoAttributeUInt32Response(status=0, value=24)

    def StartTask(self, request, context):  # noqa: N802
        self._begin('StartTask', context, request.task.name)
        return stubs.StartTaskResponse(status=0)

    def ReadAnalogF64(self, request, context):  # noqa: N802
        self._begin('ReadAnalogF64', context, request.task.name)
        values = [self.inputs.get(c, 2.5) for c in self.tasks[request.task.name]]
        return stubs.ReadAnalogF64Response(status=0, read_array=values, samps_per_chan_read=1)

    def WriteAnalogF64(self, request, context):  # noqa: N802
        self._begin('WriteAnalogF64', context, request.task.name)
        self.outputs.update(zip(self.tasks[request.task.name], request.write_array, strict=True))
        return stubs.WriteAnalogF64Response(status=0, samps_per_chan_written=1)

    def ClearTask(self, request, context):  # noqa: N802
        self._begin('ClearTask', context, request.task.name)
        self.tasks.pop(request.task.name, None)
        return stubs.ClearTaskResponse(status=0)

    def named(self, name):
        return [call for call in self.calls if call[0] == name]


@pytest.fixture
def server():
    servicer = Server()
    running = grpc.server(futures.ThreadPoolExecutor(4))
    services.add_NiDAQmxServicer_to_server(servicer, running)
    servicer.port = running.add_insecure_port('127.0.0.1:0')
    servicer.running = running
    running.start()
    yield servicer
    servicer.stall.set()
    running.stop(None).wait(5)


def data_of(server=None, **options):
    """The paper's rig on two boards: two outputs on Dev1, the third on Dev2."""
    if server is not None:
        options['server'] = f'127.0.0.1:{server.port}'
    data = channels_of(load_rig('paper_3dof'), 'nidaqmx', 'Dev1', options)
    data['struts']['strut_3']['coil'].update(device='Dev2', index=0)
    return data


def boards_of(data):
    return make_back_end(parse_channels(data, 'test'), PERIOD, 0.03)


@pytest.fixture
def boards(server):
    made = boards_of(data_of(server))
    made.open()
    yield made
    made.close()


def test_outputs_are_at_0_v_before_anything_is_read(boards, server):
    del boards
    names = [call[0] for call in server.calls]
    assert names.index('WriteAnalogF64') < names.index('CreateAIVoltageChan')
    assert server.outputs == {'Dev1/ao0': 0.0, 'Dev1/ao1': 0.0, 'Dev2/ao0': 0.0}
    assert server.named('CreateAOVoltageChan') == [
        ('CreateAOVoltageChan', f'Dev{d}/ao{i}', -10.0, 10.0) for d, i in ((1, 0), (1, 1), (2, 0))
    ]
    assert server.named('CreateAIVoltageChan') == [
        ('CreateAIVoltageChan', f'Dev1/ai{i}', -5.0, 5.0) for i in range(6)
    ]


def test_inputs_and_outputs_keep_their_order(boards, server):
    server.inputs = {f'Dev1/ai{i}': 0.5 * i for i in range(6)}
    boards.start(0.0)
    (reading,) = boards.poll(PERIOD)
    assert reading.volts.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0, 2.5]
    boards.write(np.array([1.0, -2.0, 3.0]), 0, True, 0.0)
    assert server.outputs == {'Dev1/ao0': 1.0, 'Dev1/ao1': -2.0, 'Dev2/ao0': 3.0}
    boards.zero()
    assert set(server.outputs.values()) == {0.0}


def test_a_driver_error_is_told_in_one_line(boards, server):
    """Truth: error -200279 as NI's driver says it."""
    boards.start(0.0)
    server.failing['ReadAnalogF64'] = (
        -200279,
        'The application is not able to keep up.\n\nDetails',
    )
    with pytest.raises(BackEndError) as told:
        boards.poll(PERIOD)
    assert 'read: The application is not able to keep up.' in str(told.value)
    assert '-200279' in str(told.value)
    assert '\n' not in str(told.value)


def test_a_write_error_does_not_keep_the_other_board_from_0_v(boards, server):
    boards.write(np.array([1.0, 1.0, 1.0]), 0, True, 0.0)
    server.tasks['satvib_Dev1_ao'].append('one channel too many')
    with pytest.raises(BackEndError, match='write: '):
        boards.write(np.zeros(3), 0, True, 0.0)
    assert server.outputs['Dev2/ao0'] == 0.0
    boards.zero()  # never raises


def test_a_reserved_resource_is_refused_at_open(server):
    server.failing['CreateAOVoltageChan'] = (-50103, 'The specified resource is reserved.')
    made = boards_of(data_of(server))
    with pytest.raises(SatvibError, match='outputs of Dev1: The specified resource is reserved'):
        made.open()
    made.close()


def test_a_killed_guardians_tasks_are_found_again(boards, server):
    """The tasks of one that was killed are still on the server: the next one attaches and zeroes."""
    boards.write(np.array([7.0, 7.0, 7.0]), 0, True, 0.0)
    second = boards_of(data_of(server))
    second.open()
    assert set(server.outputs.values()) == {0.0}
    assert len(server.named('CreateAOVoltageChan')) == 3
    second.close()


def test_a_server_that_hangs_is_an_error_within_its_patience(server):
    made = boards_of(data_of(server, patience=0.2))
    made.open()
    made.start(0.0)
    server.stall.clear()
    with pytest.raises(BackEndError, match=r'read: .*Deadline Exceeded'):
        made.poll(PERIOD)
    server.stall.set()
    made.close()


def test_no_server_is_said_in_one_line(server):
    server.running.stop(None).wait(5)
    made = boards_of(data_of(server))
    with pytest.raises(SatvibError, match=r'Failed to connect to server|Deadline Exceeded'):
        made.open()
    made.close()


def test_a_missing_driver_is_said_in_one_line():
    """Truth: there is no NI driver on this machine, and its library says so."""
    made = boards_of(data_of())
    with pytest.raises(SatvibError, match='nidaqmx: '):
        made.open()
    made.close()


def test_a_missing_library_names_the_command(monkeypatch):
    monkeypatch.setitem(sys.modules, 'nidaqmx', None)
    with pytest.raises(SatvibError, match=r"install it with: pip install 'nidaqmx\[grpc\]'"):
        boards_of(data_of())
