# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The description of the analog channels, from YAML.

Each channel names its own device and index, because three struts may need more than one board (the paper's PCI-6025E
has two outputs). What decides the meaning of a volt, and the limits of an output, has no default: a channel without it
is refused by name.

    acceleration = polarity (volts - zero_voltage) / sensitivity - bias
    converter    = polarity voltage / gain
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml
from satvib_common.schema import Schema, param

BACK_ENDS = ('loopback', 'replay', 'serial', 'comedi', 'nidaqmx', 'iio')


@dataclass(frozen=True, kw_only=True)
class Channel(Schema):
    """What every channel has."""

    device: str = param(description="which device; its meaning is the back end's")
    index: int = param(description='channel of the device', minimum=0)
    polarity: int = param(description='1, or -1 when the sign is turned over', choices=(1, -1))
    range: tuple[float, ...] = param(description='lowest and highest voltage', unit='V')
    bits: int = param(0, 'resolution of the converter; 0: taken as exact', minimum=0, maximum=32)

    def check(self) -> None:
        """Refuse a device without a name and a range that is not one."""
        if not self.device:
            raise SatvibError('device: is empty; name the board, port or file')
        if len(self.range) != 2 or not self.range[0] < self.range[1]:
            raise SatvibError(
                f'range: the lowest and the highest voltage are expected, not {self.range}'
            )

    @property
    def step(self) -> float:
        """Smallest step of the converter, V; 0 when it is taken as exact."""
        return (self.range[1] - self.range[0]) / 2.0**self.bits if self.bits else 0.0


@dataclass(frozen=True, kw_only=True)
class SensorChannel(Channel):
    """An analog input with an accelerometer."""

    sensitivity: float = param(description='volts per acceleration', unit='V s^2/m', above=0.0)
    zero_voltage: float = param(description='voltage at no acceleration', unit='V')
    zero_tolerance: float = param(
        description='largest offset at rest that is plausible', unit='V', above=0.0
    )
    sensor_range: float = param(
        0.0,
        'full scale of the sensor, either way: beyond it a reading is marked as clipped; 0: not known, then only the '
        'ends of the converter are marked',
        unit='m/s^2',
        minimum=0.0,
    )
    rest: float = param(
        0.0, 'what it reads at rest by its mounting: +-9.81 with a vertical axis', unit='m/s^2'
    )
    noise_limit: float = param(
        0.5, 'largest standard deviation at rest that is plausible', unit='m/s^2', above=0.0
    )
    stuck_time: float = param(
        0.5, 'equal readings for this long are a fault; 0: never', unit='s', minimum=0.0
    )

    def check(self) -> None:
        """Refuse a sensor that rests outside the converter's range."""
        super().check()
        rest = self.zero_voltage + self.polarity * self.rest * self.sensitivity
        low, high = rest - self.zero_tolerance, rest + self.zero_tolerance
        if low <= self.range[0] or high >= self.range[1]:
            raise SatvibError(
                f'zero_voltage: at rest {low:g} to {high:g} V is not inside the range of the '
                f'converter, {self.range[0]:g} to {self.range[1]:g} V'
            )
        if 0.0 < self.sensor_range <= abs(self.rest):
            raise SatvibError(
                f'sensor_range: {self.sensor_range:g} m/s^2 does not hold what the sensor reads at rest, '
                f'{self.rest:g} m/s^2'
            )


@dataclass(frozen=True, kw_only=True)
class CoilChannel(Channel):
    """An analog output with an amplifier and a voice coil."""

    gain: float = param(description='of the amplifier, coil over converter', above=0.0)
    limit: float = param(description='largest voltage at the coil', unit='V', above=0.0)
    slew: float = param(description='largest rate at the coil', unit='V/s', above=0.0)
    force_constant: float = param(description='force per current', unit='N/A', above=0.0)
    continuous_force: float = param(
        description='continuous rating of the coil', unit='N', above=0.0
    )
    resistance: float = param(description='of the winding', unit='ohm', above=0.0)
    inductance: float = param(0.0, 'of the winding', unit='H', minimum=0.0)
    transconductance: float = param(
        0.0, 'current per volt of an amplifier that drives current; 0: it drives voltage',
        unit='A/V', minimum=0.0,
    )  # fmt: skip
    thermal_time: float = param(
        10.0, 'time constant of the I^2 t watch', unit='s', above=0.0, maximum=3600.0
    )

    def check(self) -> None:
        """Refuse a converter that cannot give 0 V, or not the limit."""
        super().check()
        low, high = self.range
        if not low < 0.0 < high:
            raise SatvibError(
                f'range: {low:g} to {high:g} V does not hold both signs; use a converter that does'
            )
        asked, reach = self.limit / self.gain, min(high, -low)
        if asked > reach:
            raise SatvibError(
                f'limit: {self.limit:g} V at the coil is {asked:g} V at the converter, beyond its '
                f'{reach:g} V; lower the limit or correct the gain {self.gain:g}'
            )

    @property
    def continuous_current(self) -> float:
        """Current at the continuous force, A."""
        return self.continuous_force / self.force_constant


@dataclass(frozen=True, kw_only=True)
class StrutChannels(Schema):
    """The channels of one strut."""

    name: str = param(description='name of the strut, which is its namespace')
    upper: SensorChannel = param(description='accelerometer of the upper plate')
    lower: SensorChannel | None = param(description='of the lower plate; null: none')
    coil: CoilChannel = param(description='voice coil')


@dataclass(frozen=True, kw_only=True)
class _File(Schema):
    """The file before its struts are checked."""

    back_end: str = param(description='who drives the devices', choices=BACK_ENDS)
    options: dict[str, Any] = param(dict, 'settings of the back end')
    struts: dict[str, Any] = param(description='channels of each strut, by its name')


@dataclass(frozen=True)
class Channels:
    """All channels.

    Attributes:
        back_end: name of the back end.
        options: its settings, checked by itself.
        struts: in the order of the file.
        where: the file, for messages.
    """

    back_end: str
    options: Mapping[str, Any]
    struts: tuple[StrutChannels, ...]
    where: str = 'channels'

    @property
    def inputs(self) -> tuple[tuple[str, SensorChannel], ...]:
        """Named inputs: all upper sensors, then the lower ones that there are."""
        upper = [(f'{s.name}.upper', s.upper) for s in self.struts]
        lower = [(f'{s.name}.lower', s.lower) for s in self.struts if s.lower is not None]
        return (*upper, *lower)

    @property
    def outputs(self) -> tuple[tuple[str, CoilChannel], ...]:
        """Named outputs, strut by strut."""
        return tuple((f'{s.name}.coil', s.coil) for s in self.struts)

    def check_rate(self, rate: float) -> None:
        """Refuse a slew limit that is less than a step of the converter per sample.

        Args:
            rate: Hz, sample rate.

        Raises:
            SatvibError: the output could never move.
        """
        for name, coil in self.outputs:
            if coil.slew / rate < coil.step * coil.gain:
                raise SatvibError(
                    f'{self.where}: {name}.slew: {coil.slew:g} V/s at {rate:g} Hz is less than one '
                    f'step of the converter, {coil.step * coil.gain:g} V; the output would never move'
                )


def load_channels(path: Path) -> Channels:
    """Read and check a channels file.

    Raises:
        SatvibError: unreadable, something missing or wrong; the message names file and channel.
    """
    return parse_channels(load_yaml(path), str(path))


def parse_channels(data: Any, where: str) -> Channels:
    """Check channels given as plain data; `where` begins every message.

    Raises:
        SatvibError: something missing or wrong; the message names the channel.
    """
    file = _File.from_mapping(data, where)
    if not file.struts:
        raise SatvibError(f'{where}: struts: none is given')
    struts = []
    for name, given in file.struts.items():
        if not isinstance(name, str) or not name.isidentifier():
            raise SatvibError(f'{where}: struts: {name!r} cannot be the name of a namespace')
        if not isinstance(given, Mapping):
            raise SatvibError(f'{where}: {name}: upper, lower and coil are expected')
        struts.append(StrutChannels.from_mapping({**given, 'name': name}, f'{where}: {name}'))
    channels = Channels(file.back_end, file.options, tuple(struts), where)
    _check_shared(channels)
    return channels


def _check_shared(channels: Channels) -> None:
    """Refuse two channels on one terminal; only lower sensors may be one and the same."""
    outputs: dict[tuple[str, int], str] = {}
    for name, coil in channels.outputs:
        first = outputs.setdefault((coil.device, coil.index), name)
        if first != name:
            raise SatvibError(
                f'{channels.where}: {name}: output {coil.index} of {coil.device} belongs to {first} '
                'already; every coil needs an output of its own'
            )
    inputs: dict[tuple[str, int], str] = {}
    for name, sensor in channels.inputs:
        first = inputs.setdefault((sensor.device, sensor.index), name)
        if first != name and not (first.endswith('.lower') and name.endswith('.lower')):
            raise SatvibError(
                f'{channels.where}: {name}: input {sensor.index} of {sensor.device} belongs to '
                f'{first} already; only lower sensors may be shared'
            )
