# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of an identifier: the parameters of `strut_identifier`."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.parameters import LoopParameters
from satvib_common.phases import Phase
from satvib_common.schema import param

ESTIMATORS = ('least_squares',)
FORGETTING = ('none', 'exponential')
BIAS = ('calibrate', 'none')


@dataclass(frozen=True, kw_only=True)
class IdentifierParameters(LoopParameters):
    """Orders, estimator, forgetting, bias and what counts as trust."""

    poles: int = param(2, 'past outputs in the model, n', minimum=1, maximum=20, read_only=True)
    coefficients: int = param(3, 'inputs in the model, m', minimum=1, maximum=20, read_only=True)
    delay: int = param(
        1,
        'samples between a voltage and the first acceleration that sees it',
        unit='samples',
        minimum=0,
        maximum=100,
        read_only=True,
    )
    estimator: str = param(
        'least_squares', 'how the parameters are estimated', choices=ESTIMATORS, read_only=True
    )
    forgetting: str = param('none', 'what happens to old data', choices=FORGETTING, read_only=True)
    forgetting_factor: float = param(
        0.99,
        'lambda: weight of a sample relative to the one after it',
        above=0.0,
        maximum=1.0,
        read_only=True,
    )
    initial_covariance: float = param(
        1e18,
        'diagonal of P(0) per unit of noise variance; large: the data alone decide',
        above=0.0,
        maximum=1e30,
        read_only=True,
    )
    covariance_limit: float = param(
        1e6, 'largest trace of P that forgetting may reach', above=0.0, maximum=1e30, read_only=True
    )
    initial_theta: tuple[float, ...] = param(
        (), 'estimate to start from, a then b; empty: zeros', read_only=True
    )
    input_floor: float = param(
        1e-6,
        'a sample counts only if a voltage of its regressor is larger than this',
        unit='V',
        minimum=0.0,
        read_only=True,
    )
    estimate_in: tuple[str, ...] = param(
        ('IDENTIFY',),
        'phases in which the estimate is updated',
        choices=tuple(phase.name for phase in Phase),
        read_only=True,
    )
    bias: str = param(
        'calibrate',
        'the upper sensor: calibrate (mean over CALIBRATE is taken off) or none',
        choices=BIAS,
        read_only=True,
    )

    @property
    def dt(self) -> float:
        """Sample period, s."""
        return 1.0 / self.sample_rate

    @property
    def count(self) -> int:
        """Parameters of the model, n + m."""
        return self.poles + self.coefficients

    def check(self) -> None:
        """Check what concerns several fields."""
        if len(self.initial_theta) not in {0, self.count}:
            raise SatvibError(
                f'initial_theta: {len(self.initial_theta)} numbers; a model of {self.poles} poles and '
                f'{self.coefficients} coefficients has {self.count}'
            )
