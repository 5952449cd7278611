# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a rig is made of: a checked description, from YAML.

rig = load_rig('paper_3dof', {'payload.mass': 12.0, 'acquisition.hold': 'linear'})

The rigs that come with the package are `rigs/*.yaml`; a path names a file of one's own. Payload, struts and shaker are
in `structure`. The equations that these numbers enter are in `mechanics`, `sensor_chain` and `period`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml, parse_yaml
from satvib_common.schema import Schema, param
from satvib_common.settings_text import change_existing

from satvib_plant_sim.rig.geometry import check_geometry
from satvib_plant_sim.rig.structure import Payload, Shaker, Struts, factors


@dataclass(frozen=True, kw_only=True)
class Coil(Schema):
    """Voice coil and its amplifier."""

    force_constant: float = param(
        description='force per current, and back-EMF per speed', unit='N/A', minimum=0.0
    )
    force_scale: tuple[float, ...] = param(
        (1.0, 1.0, 1.0), 'factor on the force constant, strut by strut; 0: actuator lost'
    )
    resistance: float = param(description='winding resistance', unit='ohm', above=0.0)
    inductance: float = param(description='winding inductance', unit='H', above=0.0)
    force_limit: float = param(description='peak force', unit='N', above=0.0)
    drive: str = param('voltage', 'what the amplifier holds', choices=('voltage', 'current'))
    transconductance: float = param(1.0, 'current drive: current per volt', unit='A/V', above=0.0)
    bandwidth: float = param(1000.0, 'current drive: amplifier bandwidth', unit='Hz', above=0.0)
    gain: float = param(1.0, 'amplifier gain, converter output to terminals', above=0.0)
    voltage_limit: float = param(20.0, 'what the amplifier can give', unit='V', above=0.0)


@dataclass(frozen=True, kw_only=True)
class Accelerometer(Schema):
    """One kind of sensor on both plates of each strut."""

    range: float = param(description='full scale, either way', unit='m/s^2', above=0.0)
    bandwidth: float = param(description='-3 dB, first order', unit='Hz', above=0.0)
    sensitivity: float = param(description='output per acceleration', unit='V s^2/m', above=0.0)
    zero_voltage: float = param(0.0, 'output at rest', unit='V')
    zero_tolerance: float = param(
        0.0, 'the output at rest is off by up to this, drawn by the seed', unit='V', minimum=0.0
    )
    bias: tuple[float, ...] | None = param(
        None, 'bias of the upper sensors, then the lower; none: drawn', unit='m/s^2'
    )
    scale: tuple[float, ...] = param(
        (1.0,), 'factor on what a sensor shows: one for all, or the upper sensors, then the lower; '
        '-1: mounted the other way'
    )  # fmt: skip
    noise_rms: float = param(
        description='noise within the bandwidth, RMS', unit='m/s^2', minimum=0.0
    )


@dataclass(frozen=True, kw_only=True)
class Acquisition(Schema):
    """Sampling, anti-alias filter, converters, output hold and latency."""

    sample_rate: float = param(description='sample rate', unit='Hz', above=0.0, maximum=20e3)
    fine_rate: float = param(
        4000.0, 'truth between samples: at least this', unit='Hz', minimum=4000.0, maximum=1e6
    )
    hold: str = param(description='output between commands', choices=('zero', 'linear'))
    input_delay: float = param(
        description='from the sample to the arrival of its voltage',
        unit='s',
        minimum=0.0,
        maximum=1,
    )
    periods_late: tuple[int, ...] = param(
        (0,), 'whole sample periods that the voltage arrives later than input_delay: one for all struts, or strut by '
        'strut', minimum=0
    )  # fmt: skip
    filter_order: int = param(
        description='Butterworth anti-alias filter; 0: none', minimum=0, maximum=8
    )
    filter_corner: float = param(100.0, 'its corner, -3 dB', unit='Hz', above=0.0)
    input_bits: int = param(description='input converter; 0: exact', minimum=0, maximum=32)
    input_range: float = param(description='input full scale, either way', unit='V', above=0.0)
    output_bits: int = param(description='output converter; 0: exact', minimum=0, maximum=32)
    output_range: float = param(description='output full scale, either way', unit='V', above=0.0)

    @property
    def period(self) -> float:
        """Sample period, s."""
        return 1.0 / self.sample_rate

    @property
    def fine_steps(self) -> int:
        """Fine steps in a sample period."""
        return max(math.ceil(self.fine_rate / self.sample_rate - 1e-9), 1)


@dataclass(frozen=True, kw_only=True)
class Rig(Schema):
    """A whole rig."""

    name: str = param('rig', 'name')
    description: str = param('', 'one line for people')
    payload: Payload = param()
    struts: Struts = param()
    coil: Coil = param()
    shaker: Shaker = param()
    accelerometer: Accelerometer = param()
    acquisition: Acquisition = param()

    def check(self) -> None:
        """Refuse what does not fit together."""
        count = self.struts.count
        scale = factors(self.coil.force_scale, self.struts, 'coil.force_scale')
        if scale != self.coil.force_scale:
            object.__setattr__(self, 'coil', self.coil.replace(force_scale=scale))
        check_geometry(self.payload, self.struts)
        late = self.acquisition.periods_late
        if len(late) != 1 and len(late) != count:
            raise SatvibError(f'acquisition.periods_late: {len(late)} numbers for {count} struts')
        bias = self.accelerometer.bias
        if bias is not None and len(bias) != 2 * count:
            raise SatvibError(f'accelerometer.bias: {len(bias)} values for {2 * count} sensors')
        sensor = self.accelerometer
        if len(sensor.scale) not in {1, 2 * count}:
            raise SatvibError(
                f'accelerometer.scale: {len(sensor.scale)} factors for {2 * count} sensors'
            )
        at_rest = abs(sensor.zero_voltage) + sensor.zero_tolerance
        if at_rest >= self.acquisition.input_range:
            raise SatvibError(
                f'accelerometer.zero_voltage: {at_rest} V at rest is outside the input range, '
                f'+-{self.acquisition.input_range} V'
            )


def rig_names() -> list[str]:
    """Give the names of the rigs that come with the package."""
    folder = resources.files('satvib_plant_sim').joinpath('rigs')
    return sorted(f.name[:-5] for f in folder.iterdir() if f.name.endswith('.yaml'))


def read_rig(name_or_path: str | Path) -> tuple[dict[str, Any], str]:
    """Read the plain data of a rig, whose groups are not to be changed, and how messages call it."""
    text = str(name_or_path)
    data = _parsed(text, _identity(text))
    where = text if _is_path(text) else f'rig {text}'
    if not isinstance(data, Mapping):
        raise SatvibError(f'{where}: a mapping of keys is expected')
    return dict(data), where


def _is_path(text: str) -> bool:
    return text.endswith(('.yaml', '.yml')) or '/' in text


def _identity(text: str) -> tuple[int, ...]:
    """What changes when a rig's file is another one."""
    if not _is_path(text):
        return ()
    try:
        about = Path(text).stat()
    except OSError:
        return ()  # the reader reports the fault
    return about.st_dev, about.st_ino, about.st_mtime_ns, about.st_size


@lru_cache(maxsize=64)
def _parsed(text: str, identity: tuple[int, ...]) -> Any:  # noqa: ARG001 - tells files apart
    """Parse a rig's file once; a campaign asks for it in every trial."""
    if _is_path(text):
        return load_yaml(Path(text))
    if text not in rig_names():
        raise SatvibError(
            f'rig {text!r}: no such rig (known: {", ".join(rig_names())}; or the path of a file)'
        )
    file = resources.files('satvib_plant_sim').joinpath('rigs', f'{text}.yaml')
    return parse_yaml(file.read_text(encoding='utf-8'), f'rig {text}')


@lru_cache(maxsize=64)
def _base_rig(text: str, identity: tuple[int, ...]) -> Rig:  # noqa: ARG001
    data, where = read_rig(text)
    return Rig.from_mapping({'name': Path(text).stem, **data}, where)


def load_rig(name_or_path: str | Path, overrides: Mapping[str, Any] | None = None) -> Rig:
    """Load a rig and change some of its numbers.

    Args:
        name_or_path: a name of `rig_names()`, or the path of a YAML file (it ends in .yaml or holds a slash).
        overrides: dotted keys, as in {'payload.mass': 12.0, 'struts.stiffness_scale.1': 0.8}; list elements count
            from 0.

    Raises:
        SatvibError: no such rig, unreadable, a wrong key, type or value; the message names rig and key.
    """
    text = str(name_or_path)
    base = _base_rig(text, _identity(text))
    if not overrides:
        return base
    where = text if _is_path(text) else f'rig {text}'
    return Rig.from_mapping(change_existing(base.to_mapping(), overrides, where), where)
