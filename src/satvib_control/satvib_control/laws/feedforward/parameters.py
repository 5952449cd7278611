# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the law `feedforward`."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.schema import Fixed, param

from satvib_control.laws.parameters import LawParameters


@dataclass(frozen=True, kw_only=True)
class FeedforwardParameters(LawParameters):
    """Filter, adaptation, and protection against the reaction of the struts."""

    feedforward_method: str = param(
        'fxrls',
        'fxrls: filtered-x least squares; fxlms: filtered-x LMS, cheaper and slower; filtered_u: '
        'least squares, and the filter has poles',
        choices=('fxrls', 'fxlms', 'filtered_u'),
        read_only=Fixed.MEMORY,
    )
    feedforward_taps: int = param(
        16,
        'number of samples of the reference in the filter',
        minimum=1,
        maximum=512,
        read_only=Fixed.MEMORY,
    )
    feedforward_motion: bool = param(
        True,
        'velocity and displacement of the lower plate beside the taps; without them hundreds of '
        'taps would be needed',
        read_only=Fixed.MEMORY,
    )
    feedforward_motion_corner: float = param(
        0.5,
        'corner of the drift-free integrators of that velocity and displacement',
        unit='Hz',
        above=0.0,
        read_only=Fixed.MEMORY,
    )
    feedforward_poles: int = param(
        2,
        'number of its own past voltages in the filter of filtered_u',
        minimum=1,
        maximum=32,
        read_only=Fixed.MEMORY,
    )
    feedforward_step: float = param(
        0.1, 'step mu of fxlms; unstable from 2 on, slower below 1', above=0.0, below=2.0
    )
    feedforward_memory: float = param(
        2.0,
        'time constant of the forgetting of fxrls and filtered_u; at least a few times the '
        'duration of the filter',
        unit='s',
        above=0.0,
    )
    feedforward_leak: float = param(
        1e-3,
        'leak of the weights, as a share of the mean power of the filtered reference; it bounds '
        'the gain where the reference has no power',
        above=0.0,
        maximum=1.0,
    )
    feedforward_floor: float = param(
        0.02,
        'RMS of the reference below which the weights do not adapt',
        unit='m/s^2',
        minimum=0.0,
    )
    feedforward_weight_limit: float = param(
        100.0, 'largest 2-norm of the weights', unit='V/(m/s^2)', above=0.0
    )
    feedforward_protection_time: float = param(
        0.04,
        'length of the response of the lower sensor to the voltage of the strut; the response is '
        'learnt in IDENTIFY and subtracted from the reference; 0: no protection',
        unit='s',
        minimum=0.0,
        maximum=1.0,
        read_only=Fixed.MEMORY,
    )
    feedforward_struts: int = param(
        3,
        'number of struts on one lower plate; the reactions of the others stay in the reference, '
        'and the gain is bounded so that they cannot make the loop unstable; 1: no such bound',
        minimum=1,
        read_only=Fixed.RIG,
    )

    def check(self) -> None:
        """Check the number of poles, and the corner against the sample rate."""
        super().check()
        if self.feedforward_poles > self.feedforward_taps:
            raise SatvibError(
                f'feedforward_poles: {self.feedforward_poles} are more than feedforward_taps, '
                f'{self.feedforward_taps}'
            )
        self.check_frequencies('feedforward_motion_corner')
