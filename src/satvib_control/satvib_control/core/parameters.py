# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of what surrounds a law: guard, sensors, vibration watch and the excitation of IDENTIFY."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.schema import Fixed, param

from satvib_control.laws.parameters import LawParameters


@dataclass(frozen=True, kw_only=True)
class CoreParameters(LawParameters):
    """What `ControllerCore` reads for itself."""

    slew_limit: float = param(
        0.0,
        'largest rate of change of the voltage; 0: none',
        unit='V/s',
        minimum=0.0,
        read_only=Fixed.PROTECTION,
    )
    switch_on_time: float = param(
        0.2,
        'time over which the voltage of the law rises to its full value when CONTROL begins',
        unit='s',
        minimum=0.0,
        maximum=60.0,
    )
    calibration_limit: float = param(
        1.0,
        'largest standard deviation of the upper sensor in CALIBRATE; with more the sensor was not '
        'at rest, and the controller refuses to act',
        unit='m/s^2',
        above=0.0,
    )
    bias_limit: float = param(
        30.0,
        'largest bias of the upper sensor that CALIBRATE may find, gravity included; with more the '
        'controller refuses to act',
        unit='m/s^2',
        above=0.0,
    )
    loss_limit: int = param(
        20,
        'number of missing or not finite upper samples in a row that latches a fault; fewer give '
        '0 V each',
        unit='samples',
        minimum=1,
    )
    clipping_limit: float = param(
        0.1,
        'share of clipped samples of the upper sensor, over about a second, above which the law is taken off; 1: never',
        above=0.0,
        maximum=1.0,
        read_only=Fixed.PROTECTION,
    )
    rms_window: float = param(
        1.0, 'window of the running RMS', unit='s', above=0.0, maximum=600.0, read_only=Fixed.MEMORY
    )
    watch_loudness: float = param(
        4.0,
        'how much louder than its own open loop a strut may be before its voltage is taken off',
        unit='dB',
        minimum=1.0,
        maximum=1000.0,
        read_only=Fixed.PROTECTION,
    )
    dither: float = param(
        0.0,
        'amplitude of the excitation that is added in CONTROL, so that an identifier with CONTROL in '
        '`estimate_in` learns a rig that changes; 0: none',
        unit='V',
        minimum=0.0,
        read_only=Fixed.START,
    )
    supervised: bool = param(
        False,
        'in lockstep, wait for the judgement of the supervisor at its checks; in real time a strut '
        'never waits for it',
        read_only=Fixed.GRAPH,
    )
    watch_floor: float = param(
        0.1,
        'vibration below which no law is checked as its possible cause',
        unit='m/s^2',
        minimum=0.0,
        read_only=Fixed.PROTECTION,
    )
    excitation: str = param('squares', 'signal of IDENTIFY, by its name', read_only=Fixed.START)
    excitation_amplitude: float = param(
        10.0,
        'largest voltage of the excitation; where voltage_limit is turned below it in a run, that one',
        unit='V',
        minimum=0.0,
        read_only=Fixed.START,
    )
    excitation_frequencies: tuple[float, ...] = param(
        (1.0, 2.0), 'frequencies of the excitation; those of the paper', unit='Hz', above=0.0,
        read_only=Fixed.START,
    )  # fmt: skip

    control_at_start: bool = param(
        False,
        'CONTROL from the first sample on while there is no schedule; false: STANDBY, which is 0 V',
        read_only=Fixed.START,
    )
    state_period: float = param(
        0.05,
        'real time: time between two messages on controller_state, of which a change of phase, '
        'fault or reason needs none; 0: every sample, as always in lockstep',
        unit='s',
        minimum=0.0,
        maximum=60.0,
        read_only=Fixed.START,
    )

    def check(self) -> None:
        """Check the excitation against the sample rate."""
        super().check()
        self.check_frequencies('excitation_frequencies')

    def check_start(self) -> None:
        """Check the excitation against the voltage limit, which may be turned below it in a run."""
        super().check_start()
        if self.excitation_amplitude > self.voltage_limit:
            raise SatvibError(
                f'excitation_amplitude: {self.excitation_amplitude} V is more than voltage_limit, '
                f'{self.voltage_limit} V'
            )

    @property
    def excitation_share(self) -> float:
        """Share of the excitation that is used: 1, or less where the voltage limit was turned below its amplitude."""
        return self.voltage_limit / max(self.excitation_amplitude, self.voltage_limit)

    def effect_of(self, names: frozenset[str]) -> str:
        """Say what people should know of settings, by name, that were just set; empty: they act as set."""
        if 'voltage_limit' in names and self.excitation_share < 1.0:
            return f'the excitation of IDENTIFY is {self.voltage_limit:g} V at most, too'
        return ''


def state_every(parameters: CoreParameters, lockstep: bool) -> int:
    """How many samples lie between two messages on controller_state: those of `state_period`, 1 in lockstep."""
    p = parameters
    return 1 if lockstep else max(round(p.state_period * p.sample_rate), 1)
