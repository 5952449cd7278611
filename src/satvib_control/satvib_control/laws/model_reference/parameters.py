# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the law `model_reference`."""

from dataclasses import dataclass
from typing import Self

from satvib_common.errors import SatvibError
from satvib_common.schema import Fixed, param

from satvib_control.laws.parameters import VelocityParameters


@dataclass(frozen=True, kw_only=True)
class ModelReferenceParameters(VelocityParameters):
    """Start of the gains, reference model, and adaptation."""

    gain_p: float = param(
        0.0,
        'K_p at the start of model_reference; where it does not adapt, it can be set in the run',
        unit='V/(m/s^2)',
    )
    gain_i: float = param(
        0.0,
        'K_i at the start of model_reference; where it does not adapt, it can be set in the run',
        unit='V/(m/s)',
    )
    gain_d: float = param(
        0.0,
        'K_d at the start of model_reference; where it does not adapt, it can be set in the run',
        unit='V/(m/s^3)',
    )
    adapted_gains: tuple[str, ...] = param(
        ('ki',),
        'gains that adapt, of kp, ki, kd; the law of the paper adapts ki alone',
        choices=('kp', 'ki', 'kd'),
        read_only=Fixed.MODEL,
    )
    reference_model: str = param(
        'identified',
        'identified: the identified model, closed with the gain that gives the wanted damping; '
        'designed: a model of the second order',
        choices=('identified', 'designed'),
        read_only=Fixed.MODEL,
    )
    reference_excitation: str = param(
        'squares', 'signal of the reference u_c in ADAPT, by its name', read_only=Fixed.START
    )
    reference_frequencies: tuple[float, ...] = param(
        (5.0, 10.0), 'frequencies of the reference; near the mode they say most about the gain',
        unit='Hz', above=0.0, read_only=Fixed.MODEL,
    )  # fmt: skip
    reference_voltage: float = param(
        5.0,
        'voltage that the reference of ADAPT causes at the wanted gain',
        unit='V',
        above=0.0,
        read_only=Fixed.MODEL,
    )
    reference_damping: float = param(
        1.5,
        'wanted effective damping ratio of the dominant mode',
        above=0.0,
        maximum=10.0,
        read_only=Fixed.MODEL,
    )
    reference_frequency: float = param(
        0.0,
        'frequency of the designed reference model; 0: that of the identified dominant mode',
        unit='Hz',
        minimum=0.0,
        read_only=Fixed.MODEL,
    )
    adaptation_rule: str = param(
        'normalized',
        'normalized: MIT rule divided by the power of its gradient; mit: MIT rule as printed; '
        'lyapunov: normalized, with the regressor in the place of the sensitivity',
        choices=('normalized', 'mit', 'lyapunov'),
        read_only='the rate has another unit under another rule',
    )
    adaptation_rate: float = param(
        5.0,
        'gamma; of the normalized rules the rate of convergence in 1/s, of the MIT rule in units '
        'that follow from those of the gain',
        minimum=0.0,
    )
    adaptation_memory: float = param(
        0.25,
        'time constant of the power that normalizes the gradient',
        unit='s',
        above=0.0,
    )
    adaptation_floor: float = param(
        0.01,
        'effect of a gain on the output below which the gain does not adapt',
        unit='m/s^2',
        minimum=0.0,
    )
    adaptation_dead_zone: float = param(
        0.0, 'error below which nothing adapts', unit='m/s^2', minimum=0.0
    )
    adaptation_leakage: float = param(
        0.0,
        'sigma modification: rate at which gains return to their start',
        unit='1/s',
        minimum=0.0,
    )
    adaptation_error_leakage: float = param(
        0.0,
        'e1 modification: rate at which gains return to their start, per error',
        unit='1/s per m/s^2',
        minimum=0.0,
    )
    adapt_in_control: bool = param(
        False,
        'continue to adapt in CONTROL, on the vibration itself (y_m = 0)',
    )

    def check(self) -> None:
        """Check the frequencies against the sample rate."""
        super().check()
        self.check_frequencies('reference_frequencies', 'reference_frequency')

    def check_change(self, before: Self) -> None:
        """Refuse another start of a gain that adapts: it would change nothing that is seen."""
        super().check_change(before)
        for gain in self.adapted_gains:
            name = f'gain_{gain[1:]}'
            if getattr(self, name) != getattr(before, name):
                raise SatvibError(
                    f'{name}: {gain} adapts (adapted_gains), so its start is not set in a run'
                )
