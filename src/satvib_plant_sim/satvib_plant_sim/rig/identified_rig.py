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
from dataclasses import dataclass

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param


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
    """The acquisition of a sampled model: its rate alone."""

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
