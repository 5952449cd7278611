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
        0.0,
        "confidence of the model's covariance ellipsoid over which the margin must hold; 0: the "
        'estimate alone',
        minimum=0.0,
        below=1.0,
        read_only=True,
    )

    # velocity_feedback
    velocity_gain: float = param(
        56.1,
        "gain of velocity_feedback; the default is the paper's 550 read as V per g s",
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
    adaptation_rate: float = param(
        5.0, 'rate of the normalized MIT rule', unit='1/s', minimum=0.0, maximum=1e3
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
        'least effect of the whole gain on the output that is worth learning from; below it the '
        'adaptation stands still',
        unit='m/s^2',
        minimum=0.0,
        read_only=True,
    )
    adapt_in_control: bool = param(
        False,
        'go on adapting in CONTROL, on the vibration itself (y_m = 0)',
        read_only=True,
    )

    def check(self) -> None:
        """Check what no single field can tell."""
        from satvib_control.law import law_class

        for part in self.law.split('+'):
            law_class(part.strip())
        if self.excitation_amplitude > self.voltage_limit:
            raise SatvibError(
                f'excitation_amplitude: {self.excitation_amplitude} V is more than voltage_limit, '
                f'{self.voltage_limit} V'
            )
        nyquist = 0.5 * self.sample_rate
        for frequency in self.excitation_frequencies:
            if frequency >= nyquist:
                raise SatvibError(
                    f'excitation_frequencies: {frequency} Hz is not below half the sample rate, '
                    f'{nyquist} Hz'
                )
        if self.velocity_corner >= nyquist:
            raise SatvibError(
                f'velocity_corner: {self.velocity_corner} Hz is not below half the sample rate, '
                f'{nyquist} Hz'
            )
