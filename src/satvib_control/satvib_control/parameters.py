# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of a strut's controller; also the ROS parameters of `strut_controller`."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.parameters import LoopParameters
from satvib_common.schema import param


@dataclass(frozen=True, kw_only=True)
class ControllerParameters(LoopParameters):
    """Everything a controller can be told. Prefixes name the law that a setting belongs to."""

    strut: int = param(
        0,
        'index of the strut, from 0; struts excite with their own phase',
        minimum=0,
        read_only=True,
    )
    struts: int = param(
        3, 'struts of the isolator, among which the excitation is spread', minimum=1, read_only=True
    )
    law: str = param(
        'model_reference',
        'law by name (off, velocity_feedback, model_reference, ...), a sum as in '
        'velocity_feedback+feedforward, or a law of your own as module:Class',
        read_only=True,
    )

    # the door of the voltage
    voltage_limit: float = param(20.0, 'largest voltage', unit='V', above=0.0, maximum=1e3)
    slew_limit: float = param(
        0.0, 'largest rate of the voltage; 0: none', unit='V/s', minimum=0.0, read_only=True
    )
    switch_on_time: float = param(
        0.2,
        'time over which the voltage of the law is faded in when CONTROL begins',
        unit='s',
        minimum=0.0,
        maximum=60.0,
    )

    # sensors
    calibration_limit: float = param(
        1.0,
        'largest standard deviation of the upper sensor in CALIBRATE; more is no rest, and the '
        'controller refuses to act',
        unit='m/s^2',
        above=0.0,
    )
    loss_limit: int = param(
        20,
        'missing or not finite upper samples in a row that latch a fault; fewer give 0 V each',
        unit='samples',
        minimum=1,
    )
    rms_window: float = param(
        1.0, 'window of the running RMS', unit='s', above=0.0, maximum=600.0, read_only=True
    )

    # a law that makes the vibration grow
    watch_time: float = param(
        0.5, 'time over which the vibration is watched', unit='s', above=0.0, read_only=True
    )
    watch_ratio: float = param(
        3.0,
        'growth over the vibration at 0 V, as a ratio of RMS, that makes a law suspect',
        above=1.0,
        read_only=True,
    )
    watch_floor: float = param(
        0.1, 'vibration that is nobody to worry about', unit='m/s^2', minimum=0.0, read_only=True
    )

    # IDENTIFY
    excitation: str = param('squares', 'signal of IDENTIFY, by its name', read_only=True)
    excitation_amplitude: float = param(
        10.0, 'largest voltage of the excitation', unit='V', minimum=0.0, read_only=True
    )
    excitation_frequencies: tuple[float, ...] = param(
        (1.0, 2.0), "frequencies of the excitation; the paper's", unit='Hz', above=0.0,
        read_only=True,
    )  # fmt: skip

    excitation_options: tuple[str, ...] = param(
        (), "further settings of the excitation, each as 'key=value'", read_only=True
    )

    # what the identified model must prove
    modulus_margin: float = param(
        0.5,
        'least distance of the Nyquist curve from -1; its inverse bounds the amplification',
        minimum=0.05,
        maximum=0.95,
        read_only=True,
    )
    gain_confidence: float = param(
        0.9,
        "confidence of the model's covariance ellipsoid over which the margin must hold; 0: the "
        'estimate alone',
        minimum=0.0,
        below=1.0,
        read_only=True,
    )

    # velocity_feedback
    velocity_gain: float = param(
        56.1,
        "gain of velocity_feedback, up to the bound of the model; the paper's 550 read as V per g s",
        unit='V/(m/s)',
        minimum=0.0,
        read_only=True,
    )
    velocity_fallback_gain: float = param(
        56.1,
        'largest gain of velocity_feedback while no identified model proves it',
        unit='V/(m/s)',
        minimum=0.0,
        read_only=True,
    )
    velocity_corner: float = param(
        0.5,
        'corner of the drift-free integrator; its phase error at f is 2 atan(corner / f)',
        unit='Hz',
        above=0.0,
        read_only=True,
    )
    velocity_polarity: float = param(
        1.0,
        'sign of acceleration per volt while there is no identified model',
        choices=(1.0, -1.0),
        read_only=True,
    )

    # model_reference
    gain_p: float = param(
        0.0, 'K_p that model_reference begins with', unit='V/(m/s^2)', read_only=True
    )
    gain_i: float = param(
        0.0, 'K_i that model_reference begins with', unit='V/(m/s)', read_only=True
    )
    gain_d: float = param(
        0.0, 'K_d that model_reference begins with', unit='V/(m/s^3)', read_only=True
    )
    adapted_gains: tuple[str, ...] = param(
        ('ki',),
        "gains that adapt, of kp, ki, kd; the paper's law adapts ki alone",
        choices=('kp', 'ki', 'kd'),
        read_only=True,
    )
    reference_model: str = param(
        'identified',
        'the identified model closed with the gain of the wanted damping, or a designed one',
        choices=('identified', 'designed'),
        read_only=True,
    )
    reference_excitation: str = param(
        'squares', 'signal of the reference u_c in ADAPT, by its name', read_only=True
    )
    reference_frequencies: tuple[float, ...] = param(
        (5.0, 10.0), 'frequencies of the reference; near the mode they tell most about the gain',
        unit='Hz', above=0.0, read_only=True,
    )  # fmt: skip
    reference_voltage: float = param(
        5.0,
        'voltage that the reference of ADAPT asks for at the wanted gain',
        unit='V',
        above=0.0,
        read_only=True,
    )
    reference_damping: float = param(
        1.5,
        'wanted effective damping ratio of the dominant mode',
        above=0.0,
        maximum=10.0,
        read_only=True,
    )
    reference_frequency: float = param(
        0.0,
        'frequency of the designed reference model; 0: that of the identified dominant mode',
        unit='Hz',
        minimum=0.0,
        read_only=True,
    )
    adaptation_rule: str = param(
        'normalized',
        'normalized: MIT rule divided by the power of its gradient; mit: as printed; lyapunov: '
        'the regressor in the place of the sensitivity, normalized',
        choices=('normalized', 'mit', 'lyapunov'),
        read_only=True,
    )
    adaptation_rate: float = param(
        5.0,
        'gamma; of the normalized rules the rate of convergence in 1/s, of the MIT rule in the '
        "gain's own units",
        minimum=0.0,
    )
    adaptation_memory: float = param(
        0.25,
        'time constant of the power that normalizes the gradient',
        unit='s',
        above=0.0,
        read_only=True,
    )
    adaptation_floor: float = param(
        0.01,
        'least effect of a gain on the output that is worth learning from; below it the '
        'adaptation stands still',
        unit='m/s^2',
        minimum=0.0,
        read_only=True,
    )
    adaptation_dead_zone: float = param(
        0.0, 'error below which nothing is learnt', unit='m/s^2', minimum=0.0
    )
    adaptation_leakage: float = param(
        0.0,
        'sigma modification: rate at which gains return to their start',
        unit='1/s',
        minimum=0.0,
    )
    adaptation_error_leakage: float = param(
        0.0,
        'e1 modification: the same, per error',
        unit='1/s per m/s^2',
        minimum=0.0,
    )
    adapt_in_control: bool = param(
        False,
        'go on adapting in CONTROL, on the vibration itself (y_m = 0)',
        read_only=True,
    )

    # narrowband
    narrowband_tones: int = param(
        3, 'largest number of tones', minimum=1, maximum=8, read_only=True
    )
    narrowband_low: float = param(
        4.0, 'tones below are left alone', unit='Hz', above=0.0, read_only=True
    )
    narrowband_high: float = param(
        0.0,
        'tones above are left alone; 0: 0.45 of the sample rate',
        unit='Hz',
        minimum=0.0,
        read_only=True,
    )
    narrowband_settling: float = param(
        0.1,
        'time constant of amplitude and phase; at least one and a half periods of the tone, and '
        'longer where the modulus margin asks for it',
        unit='s',
        above=0.0,
        read_only=True,
    )
    narrowband_memory: float = param(
        5.0, 'longest memory of the frequency', unit='s', above=0.0, read_only=True
    )
    narrowband_window: float = param(
        0.5,
        'window of the spectrum in which new tones are sought; tones closer than its inverse '
        'cannot be told apart there',
        unit='s',
        above=0.0,
        read_only=True,
    )
    narrowband_smallest: float = param(
        0.0,
        'smallest amplitude that is worth a voltage; tones must also stand out of the noise',
        unit='m/s^2',
        minimum=0.0,
        read_only=True,
    )

    # feedforward
    feedforward_method: str = param(
        'fxrls',
        'fxrls: filtered-x least squares; fxlms: filtered-x LMS, cheaper and slower; filtered_u: '
        'least squares with poles of its own',
        choices=('fxrls', 'fxlms', 'filtered_u'),
        read_only=True,
    )
    feedforward_taps: int = param(
        16, 'samples of the reference in the filter', minimum=1, maximum=512, read_only=True
    )
    feedforward_motion: bool = param(
        True,
        'velocity and displacement of the lower plate beside the taps; they stand for hundreds',
        read_only=True,
    )
    feedforward_motion_corner: float = param(
        0.5,
        'corner of the drift-free integrators that make them',
        unit='Hz',
        above=0.0,
        read_only=True,
    )
    feedforward_poles: int = param(
        2, 'own past voltages in the filter of filtered_u', minimum=1, maximum=32, read_only=True
    )
    feedforward_step: float = param(
        0.1, 'step mu of fxlms; unstable from 2 on, slower below 1', above=0.0, below=2.0
    )
    feedforward_memory: float = param(
        2.0,
        'time constant of the forgetting of fxrls and filtered_u; at least some times the '
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
        'RMS of the reference below which nothing is learnt',
        unit='m/s^2',
        minimum=0.0,
    )
    feedforward_weight_limit: float = param(
        100.0, 'largest 2-norm of the weights', unit='V/(m/s^2)', above=0.0
    )
    feedforward_protection_time: float = param(
        0.04,
        "length of the response of the lower sensor to the strut's own voltage that is learnt in "
        'IDENTIFY and taken off the reference; 0: no protection',
        unit='s',
        minimum=0.0,
        maximum=1.0,
        read_only=True,
    )
    feedforward_struts: int = param(
        3,
        'struts on one lower plate; the reactions of the others stay in the reference, and the '
        'gain is kept so low that they cannot close an unstable loop; 1: no such bound',
        minimum=1,
        read_only=True,
    )

    def check(self) -> None:
        """Check what no single field can tell."""
        from satvib_control.laws.registry import law_classes

        law_classes(self.law)
        if self.excitation_amplitude > self.voltage_limit:
            raise SatvibError(
                f'excitation_amplitude: {self.excitation_amplitude} V is more than voltage_limit, '
                f'{self.voltage_limit} V'
            )
        if self.feedforward_poles > self.feedforward_taps:
            raise SatvibError(
                f'feedforward_poles: {self.feedforward_poles} are more than feedforward_taps, '
                f'{self.feedforward_taps}'
            )
        nyquist = 0.5 * self.sample_rate
        if 'narrowband' in self.law:
            high = self.narrowband_high or 0.45 * self.sample_rate
            if not self.narrowband_low < high < nyquist:
                raise SatvibError(
                    f'narrowband_low, narrowband_high: {self.narrowband_low} to {high} Hz is not a '
                    f'band below half the sample rate, {nyquist} Hz'
                )
        for name in (
            'excitation_frequencies',
            'reference_frequencies',
            'reference_frequency',
            'velocity_corner',
            'feedforward_motion_corner',
        ):
            value = getattr(self, name)
            for frequency in value if isinstance(value, tuple) else (value,):
                if frequency >= nyquist:
                    raise SatvibError(
                        f'{name}: {frequency} Hz is not below half the sample rate, {nyquist} Hz'
                    )
