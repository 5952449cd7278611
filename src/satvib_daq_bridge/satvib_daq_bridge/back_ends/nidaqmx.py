# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back end `nidaqmx`: NI boards, by the driver on this machine or by an NI gRPC Device Server (option `server`).

A device is a name such as Dev1; input i is Dev1/ai<i>, output i Dev1/ao<i>. The host keeps the time and reads and
writes single samples on demand. Every call to a server has a deadline, so that a network that hangs is an error and
not a guardian that hangs. Tasks on a server have fixed names and are attached to when they exist: so a guardian that
comes after one that was killed finds its outputs again and puts them to 0 V.
"""

import contextlib
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param

from satvib_daq_bridge.back_ends.base import (
    Array,
    BackEnd,
    BackEndError,
    Reading,
    by_device,
    missing_library,
    options_of,
)
from satvib_daq_bridge.back_ends.ticker import Ticker
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


class NiBoards(BackEnd):
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
        self._readers: list[_Task] = []
        self._writers: list[_Task] = []
        self._ticker = Ticker(period)

    def open(self) -> str:
        """Make the tasks; outputs first, at 0 V."""
        try:
            for device, group in by_device(self.channels.outputs).items():
                self._writers.append(self._writer(device, group))
            self.write(np.zeros(len(self.channels.outputs)), 0, False, 0.0)
            for device, group in by_device(self.channels.inputs).items():
                self._readers.append(self._reader(device, group))
        except BackEndError as error:
            raise SatvibError(str(error)) from None
        devices = sorted({c.device for _, c in (*self.channels.inputs, *self.channels.outputs)})
        return f'NI-DAQmx: {", ".join(devices)}, {self.options.server or "local driver"}'

    def start(self, now: float) -> None:
        """Begin to tick; from now on nothing may take long."""
        self._deadline.seconds = self.options.patience
        self._ticker.start(now)

    def due(self) -> float:
        """The next tick."""
        return self._ticker.due()

    def poll(self, now: float) -> list[Reading]:
        """Read all inputs when it is time."""
        tick = self._ticker.take(now)
        if tick is None:
            return []
        index, when = tick
        volts = np.empty(len(self.channels.inputs))
        for reader in self._readers:
            values = np.empty(len(reader.positions))
            with self._told('read'):
                reader.transfer(values)
            volts[reader.positions] = values
        return [Reading(index, when, volts, max(time.monotonic() - when, 0.0))]

    def write(self, volts: Array, sequence: int, enable: bool, now: float) -> None:
        """Write all outputs; a device that fails does not keep the others from being written."""
        del sequence, enable, now
        failed: BackEndError | None = None
        for writer in self._writers:
            try:
                with self._told('write'):
                    writer.transfer(np.ascontiguousarray(volts[writer.positions]))
            except BackEndError as error:
                failed = failed or error
        if failed is not None:
            raise failed

    def zero(self) -> None:
        """Write 0 V to every output."""
        for writer in self._writers:
            with contextlib.suppress(BackEndError), self._told('write'):
                writer.transfer(np.zeros(len(writer.positions)))

    def close(self) -> None:
        """Clear the tasks."""
        for made in (*self._readers, *self._writers):
            with contextlib.suppress(BackEndError), self._told('close'):
                made.task.close()
        self._readers, self._writers = [], []
        if self._channel is not None:
            self._channel.close()

    def figures(self) -> dict[str, float]:
        """Ticks that were missed."""
        return {'samples lost': float(self._ticker.lost)}

    def _reader(self, device: str, group: list[tuple[int, Any]]) -> _Task:
        constants = self._library.constants
        task = self._task(f'satvib_{device}_ai')
        with self._told(f'inputs of {device}'):
            if not task.channel_names:
                reference = constants.TerminalConfiguration[self.options.reference.upper()]
                for _, sensor in group:
                    task.ai_channels.add_ai_voltage_chan(
                        f'{device}/ai{sensor.index}', terminal_config=reference,
                        min_val=sensor.range[0], max_val=sensor.range[1],
                    )  # fmt: skip
            task.start()
        stream = self._library.stream_readers.AnalogMultiChannelReader(task.in_stream)
        stream.verify_array_shape = False  # it would ask the device each time
        return _Task([p for p, _ in group], task, lambda values: stream.read_one_sample(values))

    def _writer(self, device: str, group: list[tuple[int, Any]]) -> _Task:
        task = self._task(f'satvib_{device}_ao')
        with self._told(f'outputs of {device}'):
            if not task.channel_names:
                for _, coil in group:
                    task.ao_channels.add_ao_voltage_chan(
                        f'{device}/ao{coil.index}', min_val=coil.range[0], max_val=coil.range[1]
                    )
        stream = self._library.stream_writers.AnalogMultiChannelWriter(task.out_stream)
        stream.verify_array_shape = False
        return _Task([p for p, _ in group], task, lambda values: stream.write_one_sample(values))

    def _task(self, name: str) -> Any:
        with self._told(name):
            if self._channel is None:
                return self._library.Task()
            options = self._library.GrpcSessionOptions(self._channel, name)
            return self._library.Task(name, grpc_options=options)

    @contextlib.contextmanager
    def _told(self, where: str) -> Iterator[None]:
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
