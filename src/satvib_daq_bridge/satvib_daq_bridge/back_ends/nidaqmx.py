# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back end `nidaqmx`: NI boards, by the driver on this machine or by an NI gRPC Device Server (option `server`).

A device is a name such as Dev1; input i is Dev1/ai<i>, output i Dev1/ao<i>. The host keeps the time and reads and
writes single samples on demand. Every call to a server has a deadline: when the network hangs, the call fails and the
guardian goes on. Tasks on a server have fixed names, and an existing task is used again. So the guardian that follows a
killed one finds its outputs and puts them to 0 V.
"""

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param

from satvib_daq_bridge.back_ends.base import (
    BackEndError,
    by_device,
    missing_library,
    options_of,
)
from satvib_daq_bridge.back_ends.pace.polled import Polled
from satvib_daq_bridge.channels import Channels

_REFERENCES = ('default', 'rse', 'nrse', 'diff', 'pseudo_diff')
_INSTALL = "pip install 'nidaqmx[grpc]'"
_SET_UP = 10.0  # s, for a call before samples flow


@dataclass(frozen=True, kw_only=True)
class Options(Schema):
    """Settings of NI-DAQmx."""

    server: str = param('', 'address of a gRPC device server, host:port; empty: the local driver')
    reference: str = param('default', 'what the inputs are measured against', choices=_REFERENCES)
    patience: float = param(
        0.1, 'longest answer of a server once samples flow', unit='s', above=0.0
    )


@dataclass
class _Deadline:
    """How long a call to a server may take, s."""

    seconds: float


@dataclass(frozen=True)
class _Task:
    """The task of one device in one direction.

    Attributes:
        positions: of its channels among all inputs, or all outputs.
        task: of the library.
        transfer: reads into, or writes from, an array (positions).
    """

    positions: list[int]
    task: Any
    transfer: Callable[[Array], Any]


class NiBoards(Polled):
    """One or more NI devices."""

    def __init__(
        self, channels: Channels, period: float, lifetime: float, options: Options
    ) -> None:
        super().__init__(channels, period, lifetime)
        try:
            import nidaqmx
            import nidaqmx.constants
            import nidaqmx.errors
            import nidaqmx.stream_readers
            import nidaqmx.stream_writers
        except ImportError as error:
            raise missing_library('nidaqmx', str(error.name), _INSTALL) from None
        self._library = nidaqmx
        self.options = options
        self._deadline = _Deadline(_SET_UP)
        self._channel = _connect(options.server, self._deadline) if options.server else None
        self._input_tasks: list[_Task] = []
        self._output_tasks: list[_Task] = []

    def open(self) -> str:
        """Make the tasks; outputs first, at 0 V."""
        try:
            for device, group in by_device(self.channels.outputs).items():
                self._output_tasks.append(self._writer(device, group))
                self.writers.append(partial(self._put, self._output_tasks[-1]))
            self.write(np.zeros(len(self.channels.outputs)), 0, False, 0.0)
            for device, group in by_device(self.channels.inputs).items():
                self._input_tasks.append(self._reader(device, group))
        except BackEndError as error:
            raise SatvibError(str(error)) from None
        devices = sorted({c.device for _, c in (*self.channels.inputs, *self.channels.outputs)})
        return f'NI-DAQmx: {", ".join(devices)}, {self.options.server or "local driver"}'

    def start(self, now: float) -> None:
        """Start the clock; from now on each call has the short deadline."""
        self._deadline.seconds = self.options.patience
        super().start(now)

    def read(self) -> Array:
        """Read one device after the other."""
        volts = np.empty(len(self.channels.inputs))
        for made in self._input_tasks:
            values = np.empty(len(made.positions))
            with self._library_errors('read'):
                made.transfer(values)
            volts[made.positions] = values
        return volts

    def close(self) -> None:
        """Clear the tasks."""
        for made in (*self._input_tasks, *self._output_tasks):
            with contextlib.suppress(BackEndError), self._library_errors('close'):
                made.task.close()
        self._input_tasks, self._output_tasks, self.writers = [], [], []
        if self._channel is not None:
            self._channel.close()

    def _put(self, made: _Task, volts: Array) -> None:
        with self._library_errors('write'):
            made.transfer(np.ascontiguousarray(volts[made.positions]))

    def _reader(self, device: str, group: list[tuple[int, Any]]) -> _Task:
        constants = self._library.constants
        task = self._task(f'satvib_{device}_ai')
        with self._library_errors(f'inputs of {device}'):
            if not task.channel_names:
                reference = constants.TerminalConfiguration[self.options.reference.upper()]
                for _, sensor in group:
                    task.ai_channels.add_ai_voltage_chan(
                        f'{device}/ai{sensor.index}', terminal_config=reference,
                        min_val=sensor.range[0], max_val=sensor.range[1],
                    )  # fmt: skip
            task.start()
        stream = self._library.stream_readers.AnalogMultiChannelReader(task.in_stream)
        stream.verify_array_shape = False  # the check would query the device each time
        return _Task([p for p, _ in group], task, lambda values: stream.read_one_sample(values))

    def _writer(self, device: str, group: list[tuple[int, Any]]) -> _Task:
        task = self._task(f'satvib_{device}_ao')
        with self._library_errors(f'outputs of {device}'):
            if not task.channel_names:
                for _, coil in group:
                    task.ao_channels.add_ao_voltage_chan(
                        f'{device}/ao{coil.index}', min_val=coil.range[0], max_val=coil.range[1]
                    )
        stream = self._library.stream_writers.AnalogMultiChannelWriter(task.out_stream)
        stream.verify_array_shape = False
        return _Task([p for p, _ in group], task, lambda values: stream.write_one_sample(values))

    def _task(self, name: str) -> Any:
        with self._library_errors(name):
            if self._channel is None:
                return self._library.Task()
            options = self._library.GrpcSessionOptions(self._channel, name)
            return self._library.Task(name, grpc_options=options)

    @contextlib.contextmanager
    def _library_errors(self, where: str) -> Iterator[None]:
        """Turn the library's errors into one line."""
        try:
            yield
        except self._library.errors.Error as error:
            said = ' '.join(str(error).split())
            raise BackEndError(f'nidaqmx: {where}: {said}') from None


def _connect(server: str, deadline: _Deadline) -> Any:
    """A channel to a server on which every call has a deadline."""
    try:
        import grpc
    except ImportError:
        raise missing_library('nidaqmx', 'grpc', _INSTALL) from None

    class Details(grpc.ClientCallDetails):  # type: ignore[misc]
        """A call's details with another deadline."""

        def __init__(self, given: Any) -> None:
            for name in ('method', 'metadata', 'credentials', 'wait_for_ready', 'compression'):
                setattr(self, name, getattr(given, name, None))
            self.timeout = deadline.seconds

    class Interceptor(grpc.UnaryUnaryClientInterceptor):  # type: ignore[misc]
        """Gives every call a deadline."""

        def intercept_unary_unary(self, continuation: Any, details: Any, request: Any) -> Any:
            return continuation(Details(details), request)

    return grpc.intercept_channel(grpc.insecure_channel(server), Interceptor())


def make(channels: Channels, period: float, lifetime: float) -> NiBoards:
    """Build it."""
    return NiBoards(channels, period, lifetime, options_of(Options, channels))
