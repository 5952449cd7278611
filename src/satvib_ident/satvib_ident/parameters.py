# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of an identifier: the parameters of `strut_identifier`."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.parameters import LoopParameters
from satvib_common.phases import Phase
from satvib_common.schema import Fixed, param

ESTIMATORS = (
    'least_squares',
    'extended',
    'instrumental',
    'continuous_gradient',
    'continuous_least_squares',
    'continuous_normalized',
)
FORGETTING = (
    'none',
    'exponential',
    'variable_rate',
    'directional',
    'resetting',
    'dead_zone',
    'window',
)
BIAS = ('calibrate', 'none')


@dataclass(frozen=True, kw_only=True)
class IdentifierParameters(LoopParameters):
    """Orders, estimator, forgetting, bias and what counts as trust."""

    poles: int = param(
        2, 'past outputs in the model, n', minimum=1, maximum=20, read_only=Fixed.MEMORY
    )
    coefficients: int = param(
        3, 'inputs in the model, m', minimum=1, maximum=20, read_only=Fixed.MEMORY
    )
    delay: int = param(
        1,
        'samples between a voltage and the first acceleration that sees it',
        unit='samples',
        minimum=0,
        maximum=100,
        read_only=Fixed.MEMORY,
    )
    estimator: str = param(
        'least_squares',
        'least_squares (Theorem 4.1), extended (with a model of the noise) or instrumental '
        '(instrumental variable: free of bias from sensor noise); continuous_gradient, '
        'continuous_least_squares (Eqs. 16, 17), continuous_normalized (Eq. 18)',
        choices=ESTIMATORS,
        read_only=Fixed.MEMORY,
    )
    noise_coefficients: int = param(
        2, 'coefficients of the noise model, c (extended, instrumental)', minimum=1, maximum=20,
        read_only=Fixed.MEMORY,
    )  # fmt: skip
    filter_corner: float = param(
        10.0, 'continuous_*: corner of the state-variable filters', unit='Hz', above=0.0,
        read_only=Fixed.MEMORY,
    )  # fmt: skip
    gain: float = param(
        1.0, 'continuous_*: gain g of Eq. (18)', above=0.0, read_only=Fixed.ESTIMATE
    )
    normalization: float = param(
        1.0, 'continuous_normalized: mu of Eq. (18)', minimum=0.0, read_only=Fixed.ESTIMATE
    )
    initial_covariance: float = param(
        1e18, 'diagonal of P(0) per unit of noise variance; large: the data alone decide', above=0.0,
        maximum=1e30, read_only=Fixed.ESTIMATE,
    )  # fmt: skip
    covariance_limit: float = param(
        1e6,
        'largest trace of P that forgetting may reach',
        above=0.0,
        maximum=1e30,
        read_only=Fixed.ESTIMATE,
    )
    initial_theta: tuple[float, ...] = param(
        (), 'estimate to start from, a then b; empty: zeros', read_only=Fixed.ESTIMATE
    )

    forgetting: str = param(
        'none', 'rule for old data', choices=FORGETTING, read_only=Fixed.ESTIMATE
    )
    forgetting_factor: float = param(
        0.99,
        'lambda of exponential and directional forgetting: weight of a sample relative to the next',
        above=0.0,
        maximum=1.0,
        read_only=Fixed.ESTIMATE,
    )
    regressor_floor: float = param(
        0.0, 'a sample whose regressor is shorter than this (m/s^2 and V mixed) is left out; for '
        'directional also the RMS up to which a direction is not forgotten; 0: the length that the noise of '
        'CALIBRATE exceeds once in a million samples (for a direction: twice its deviation), if '
        'anything is forgotten',
        minimum=0.0, read_only=Fixed.ESTIMATE,
    )  # fmt: skip
    short_window: int = param(
        20, 'variable_rate and directional: the recent errors', unit='samples', minimum=1, maximum=100000,
        read_only=Fixed.MEMORY,
    )  # fmt: skip
    long_window: int = param(
        100, 'variable_rate and directional: the errors before those', unit='samples', minimum=1, maximum=100000,
        read_only=Fixed.MEMORY,
    )  # fmt: skip
    confidence: float = param(
        0.999, 'variable_rate and directional: probability to forget nothing while nothing changes', above=0.0,
        below=1.0, read_only=Fixed.ESTIMATE,
    )  # fmt: skip
    forgetting_rate: float = param(
        1.0,
        'variable_rate and directional: eta, how fast to forget after a change',
        minimum=0.0,
        read_only=Fixed.ESTIMATE,
    )
    forgetting_smallest: float = param(
        0.5, 'variable_rate and directional: smallest lambda after a change', above=0.0, maximum=1.0,
        read_only=Fixed.ESTIMATE,
    )  # fmt: skip
    error_floor: float = param(
        1e-6, 'variable_rate and directional: errors below this count as this', unit='m/s^2', above=0.0,
        read_only=Fixed.ESTIMATE,
    )  # fmt: skip
    reset_threshold: float = param(
        1e-4, 'resetting: P is reset when its smallest eigenvalue is below', above=0.0,
        read_only=Fixed.ESTIMATE,
    )  # fmt: skip
    reset_covariance: float = param(
        1.0, 'resetting: diagonal of P after a reset', above=0.0, read_only=Fixed.ESTIMATE
    )
    dead_zone: float = param(
        0.3,
        'dead_zone: errors up to this are left out',
        unit='m/s^2',
        minimum=0.0,
        read_only=Fixed.ESTIMATE,
    )
    window: int = param(
        200, 'window: the samples that count', unit='samples', minimum=1, maximum=100000,
        read_only=Fixed.MEMORY,
    )  # fmt: skip

    estimate_in: tuple[str, ...] = param(
        ('IDENTIFY',), 'phases in which the estimate is updated',
        choices=tuple(phase.name for phase in Phase), read_only=Fixed.ESTIMATE,
    )  # fmt: skip
    input_floor: float = param(
        1e-6,
        'a voltage up to this is no excitation',
        unit='V',
        minimum=0.0,
        read_only=Fixed.ESTIMATE,
    )
    input_hold: float = param(
        0.5, 'samples count for this long after the last excitation; later ones hold noise alone',
        unit='s', minimum=0.0, read_only=Fixed.ESTIMATE,
    )  # fmt: skip
    bias: str = param(
        'calibrate', 'the upper sensor: calibrate (mean over CALIBRATE is taken off) or none',
        choices=BIAS, read_only=Fixed.ESTIMATE,
    )  # fmt: skip

    measure_period: int = param(
        0, 'samples between evaluations of the measures of trust; 0: those of 0.05 s',
        unit='samples', minimum=0, read_only=Fixed.MEMORY,
    )  # fmt: skip
    measure_window: int = param(
        0, 'samples that excitation order, whiteness and residual are looked at; 0: those of 2 s',
        unit='samples', minimum=0, maximum=1000000, read_only=Fixed.MEMORY,
    )  # fmt: skip
    whiteness_lags: int = param(
        10, 'lags of the whiteness test, h', minimum=1, read_only=Fixed.MEMORY
    )
    error_lags: int = param(
        0, 'length of the filter that looks for the input in the residual; 0: the samples of 0.2 s, '
        '10 to 100', unit='samples', minimum=0, maximum=1000, read_only=Fixed.MEMORY,
    )  # fmt: skip
    trust_samples: int = param(10, 'samples per parameter that a trusted model needs', minimum=1)
    trust_pole_modulus: float = param(
        1.0, 'poles of a trusted model lie inside this circle', above=0.0
    )
    trust_condition: float = param(
        1e8, 'condition of the normalized information that a trusted model stays below', above=1.0
    )
    trust_band: tuple[float, ...] = param(
        (5.0, 20.0), 'band in which the response of a trusted model is known', unit='Hz', above=0.0,
        read_only=Fixed.MEMORY,
    )  # fmt: skip
    trust_deviation: float = param(
        0.25, 'relative deviation of that response that a trusted model stays below', above=0.0
    )
    trust_error: float = param(
        0.3, 'relative error of that response, from the residual, that a trusted model stays below',
        above=0.0,
    )  # fmt: skip
    trust_whiteness: float = param(
        0.0, 'Ljung-Box statistic over its lags that a trusted model stays below; 0: not asked for',
        minimum=0.0,
    )  # fmt: skip

    @property
    def dt(self) -> float:
        """Sample period, s."""
        return 1.0 / self.sample_rate

    @property
    def count(self) -> int:
        """Parameters of the model, n + m."""
        return self.poles + self.coefficients

    @property
    def floor_from_noise(self) -> bool:
        """Whether the floor of the regressor follows from the noise in CALIBRATE."""
        return (
            self.regressor_floor == 0.0
            and self.forgetting != 'none'
            and self.bias == 'calibrate'
            and not self.estimator.startswith('continuous')  # their regressors are filtered
        )

    def check(self) -> None:
        """Check what concerns several fields."""
        if len(self.initial_theta) not in {0, self.count}:
            raise SatvibError(
                f'initial_theta: {len(self.initial_theta)} numbers; a model of {self.poles} poles and '
                f'{self.coefficients} coefficients has {self.count}'
            )
        if self.reset_threshold >= self.reset_covariance:
            raise SatvibError(
                f'reset_threshold: {self.reset_threshold} is not below reset_covariance, '
                f'{self.reset_covariance}'
            )
        simple = ('none', 'exponential', 'variable_rate', 'dead_zone')
        if self.estimator == 'instrumental' and self.forgetting not in simple:
            raise SatvibError(
                f'forgetting: {self.forgetting} does not go with estimator instrumental; one of '
                f'{", ".join(simple)} does'
            )
        if self.estimator.startswith('continuous'):
            if self.coefficients != self.poles + 1:
                raise SatvibError(
                    f'coefficients: {self.coefficients}; in continuous time poles + 1 = '
                    f'{self.poles + 1} are estimated'
                )
            if self.filter_corner * self.dt >= 0.5:
                raise SatvibError(
                    f'filter_corner: {self.filter_corner} Hz is not below half the sample rate, '
                    f'{self.sample_rate / 2.0:g} Hz'
                )
        if self.estimator == 'continuous_normalized' and self.initial_covariance > 1e6:
            raise SatvibError(
                f'initial_covariance: {self.initial_covariance:g} is more than 1e6; '
                'continuous_normalized sheds it only as exp(-gain t / normalization)'
            )
        low, high = (*self.trust_band, 0.0, 0.0)[:2]
        if len(self.trust_band) != 2 or not low <= high or high * self.dt >= 0.5:
            raise SatvibError(
                f'trust_band: {list(self.trust_band)}; low and high in Hz below half the sample '
                f'rate, {self.sample_rate / 2.0:g} Hz, are needed'
            )
