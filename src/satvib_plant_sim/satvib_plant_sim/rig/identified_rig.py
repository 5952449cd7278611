# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A rig that is an identified model: `plant: iir` in its YAML.

    y = B / A sat(u) + B_p / A_p d + noise,   A(q) y(k) = b_1 u(k - delay) + b_2 u(k - delay - 1) + ...

one model per strut, sampled, so there is nothing between the samples. A strut's model stands in the rig, or is the file
that `satvib identify --save` wrote:

    plant: iir
    acquisition: {sample_rate: 100.0}
    models:
      - {file: strut_1.yaml}
      - {delay: 1, a: [-0.46, 0.158], b: [0.061, -0.103, 0.033]}
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, load_yaml, param

from satvib_plant_sim.rig.rig import Rig, apply_overrides, load_rig, read_rig

_MODEL_FORMAT = 'satvib-model-1'


@dataclass(frozen=True, kw_only=True)
class IirStrut(Schema):
    """The model of one strut."""

    delay: int = param(1, 'u(k - delay) is the first that y(k) sees', unit='samples', minimum=1)
    a: tuple[float, ...] = param(description='a_1, a_2, ...')
    b: tuple[float, ...] = param(description='b_1, b_2, ..., in m/s^2 per V')
    primary_a: tuple[float, ...] = param((), 'a_1, ... from the disturbance to the output')
    primary_b: tuple[float, ...] = param((1.0,), 'b_1, ... from the disturbance, without delay')

    def check(self) -> None:
        """Refuse a model without input and one that runs away."""
        if not self.b:
            raise SatvibError('b: empty')
        for name in ('a', 'primary_a'):
            poles = np.roots([1.0, *getattr(self, name)])
            if np.any(np.abs(poles) >= 1.0):
                size = float(np.max(np.abs(poles)))
                raise SatvibError(f'{name}: unstable, a pole of magnitude {size:.6g}')


@dataclass(frozen=True, kw_only=True)
class IirAcquisition(Schema):
    """What of an acquisition a sampled model leaves to say."""

    sample_rate: float = param(description='of the models', unit='Hz', above=0.0, maximum=20e3)

    @property
    def period(self) -> float:
        """Sample period, s."""
        return 1.0 / self.sample_rate


@dataclass(frozen=True, kw_only=True)
class IirRig(Schema):
    """Identified models in place of a mechanical rig."""

    plant: str = param('iir', 'kind of rig', choices=('iir',))
    name: str = param('rig', 'name')
    description: str = param('', 'one line for people')
    acquisition: IirAcquisition = param()
    models: tuple[IirStrut, ...] = param(description='one per strut')
    voltage_limit: float = param(20.0, 'what reaches the plant', unit='V', above=0.0)
    noise_rms: float = param(0.0, 'white noise of a reading', unit='m/s^2', minimum=0.0)
    quantum: float = param(0.0, 'step of a reading; 0: none', unit='m/s^2', minimum=0.0)
    bias: float = param(0.0, 'bias of a reading', unit='m/s^2')

    def check(self) -> None:
        """Refuse a rig without struts."""
        if not self.models:
            raise SatvibError('models: empty')

    def noise_floor(self) -> float:
        """Give what a reading at rest shows, RMS about its mean, m/s^2."""
        return math.hypot(self.noise_rms, self.quantum / math.sqrt(12.0))


def load_any_rig(
    name_or_path: str | Path, overrides: Mapping[str, Any] | None = None
) -> Rig | IirRig:
    """Load a rig of either kind, as `load_rig` does; files of models are taken in.

    Raises:
        SatvibError: as `load_rig`; a model that is missing, unstable, or of another sample rate.
    """
    data, where = read_rig(name_or_path)
    if data.get('plant') != 'iir':
        return load_rig(name_or_path, overrides)
    models = data.get('models')
    rate = (data.get('acquisition') or {}).get('sample_rate')
    if isinstance(models, list):
        folder = Path(name_or_path).parent
        data = {**data, 'models': [_model(m, folder, rate, where) for m in models]}
    rig = IirRig.from_mapping({'name': Path(name_or_path).stem, **data}, where)
    if not overrides:
        return rig
    return IirRig.from_mapping(apply_overrides(rig.to_mapping(), overrides, where), where)


def _model(entry: Any, folder: Path, rate: Any, where: str) -> Any:
    """Put what a model's file says in the place of its name."""
    if not isinstance(entry, Mapping) or 'file' not in entry:
        return entry
    path = folder / str(entry['file'])
    data = load_yaml(path)
    if not isinstance(data, Mapping) or data.get('format') != _MODEL_FORMAT:
        raise SatvibError(f'{where}: models: {path} is not a model file ({_MODEL_FORMAT})')
    model = dict(data.get('model') or {})
    period = model.pop('sample_period', None)
    if not isinstance(period, float) or not isinstance(rate, int | float):
        raise SatvibError(f'{where}: models: {path}: its sample period or the rig rate is missing')
    if abs(period * rate - 1.0) > 1e-6:
        raise SatvibError(
            f'{where}: models: {path} is sampled at {1.0 / period:g} Hz, the rig at {rate:g} Hz'
        )
    return {**model, **{k: v for k, v in entry.items() if k != 'file'}}
