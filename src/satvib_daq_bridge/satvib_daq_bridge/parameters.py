# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the daq_bridge node."""

from dataclasses import dataclass

from satvib_common.parameters import sample_rate
from satvib_common.schema import Fixed, Schema, param

# s
_SHORTEST_TIMEOUT = 0.02
_LONGEST_TIMEOUT = 0.05
_SHORTEST_SILENCE = 0.05


@dataclass(frozen=True, kw_only=True)
class BridgeParameters(Schema):
    """Channels, sample rate, and the longest silences."""

    channels: str = param(description='path of the channels file', read_only=Fixed.RIG)
    sample_rate: float = sample_rate()
    command_timeout: float = param(
        0.0,
        'oldest command that may act, counted from its sample; 0: the larger of 3 periods and '
        '20 ms, at most 50 ms',
        unit='s',
        minimum=0.0,
        maximum=_LONGEST_TIMEOUT,
        read_only=Fixed.PROTECTION,
    )
    sample_timeout: float = param(
        0.0,
        'longest silence of the device; 0: the larger of 5 periods and 50 ms',
        unit='s',
        minimum=0.0,
        read_only=Fixed.PROTECTION,
    )
    calibration_time: float = param(
        1.0,
        'how long the bias is measured, at rest and 0 V',
        unit='s',
        minimum=1.0,
        read_only=Fixed.START,
    )
    calibration_file: str = param(
        '', 'where the bias is written; empty: nowhere', read_only=Fixed.START
    )
    railed_samples: int = param(
        5,
        'readings in a row at an end of the range that are a fault',
        minimum=1,
        read_only=Fixed.PROTECTION,
    )
    missed_limit: int = param(
        5,
        'deadlines missed in a row that are a fault; 0: never',
        minimum=0,
        read_only=Fixed.PROTECTION,
    )
    wait_for_schedule: bool = param(
        True,
        'begin with sample 0 when the schedule is there and the bridge is armed',
        read_only=Fixed.START,
    )
    cpu: int = param(-1, 'processor to run on; -1: any', minimum=-1, read_only=Fixed.START)
    priority: int = param(
        0,
        'SCHED_FIFO priority; 0: the ordinary scheduler',
        minimum=0,
        maximum=98,
        read_only=Fixed.START,
    )
    guardian_cpu: int = param(
        -1, 'processor of the guardian; -1: any', minimum=-1, read_only=Fixed.START
    )
    guardian_priority: int = param(
        0,
        'SCHED_FIFO priority of the guardian; 0: ordinary',
        minimum=0,
        maximum=99,
        read_only=Fixed.START,
    )

    @property
    def period(self) -> float:
        """Sample period, s."""
        return 1.0 / self.sample_rate

    @property
    def max_age(self) -> float:
        """Oldest command that may act, s."""
        default = min(max(3.0 * self.period, _SHORTEST_TIMEOUT), _LONGEST_TIMEOUT)
        return self.command_timeout or default

    @property
    def silence(self) -> float:
        """Longest silence of the device, s."""
        return self.sample_timeout or max(5.0 * self.period, _SHORTEST_SILENCE)
