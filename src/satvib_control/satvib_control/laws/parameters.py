# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters that every law may read, and those of the velocity that several laws share."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.parameters import LoopParameters
from satvib_common.schema import Fixed, param


@dataclass(frozen=True, kw_only=True)
class LawParameters(LoopParameters):
    """What every law may read, of whatever kind it is."""

    strut: int = param(
        0,
        'index of the strut, from 0; every strut excites with its own phase',
        minimum=0,
        read_only=Fixed.RIG,
    )
    struts: int = param(
        3,
        'number of struts of the isolator; they share the excitation',
        minimum=1,
        read_only=Fixed.RIG,
    )
    law: str = param(
        'model_reference',
        'law by name (off, velocity_feedback, model_reference, ...), a sum such as '
        'velocity_feedback+feedforward, or a law of your own as module:Class',
        read_only=Fixed.MEMORY,
    )
    voltage_limit: float = param(
        20.0,
        'largest voltage, from the next sample on, in every phase; at the start at least excitation_amplitude',
        unit='V',
        above=0.0,
        maximum=1e3,
    )
    modulus_margin: float = param(
        0.5,
        'least distance of the Nyquist curve from -1; its inverse is the largest amplification',
        minimum=0.05,
        maximum=0.95,
        read_only=Fixed.MODEL,
    )
    gain_confidence: float = param(
        0.9,
        'probability of the confidence ellipsoid of the model over which the margin must hold; 0: '
        'the estimate alone',
        minimum=0.0,
        below=1.0,
        read_only=Fixed.MODEL,
    )
    excitation_options: tuple[str, ...] = param(
        (), "further settings of the excitation, each as 'key=value'", read_only=Fixed.START
    )
    watch_time: float = param(
        0.5,
        'time over which the vibration is watched',
        unit='s',
        above=0.0,
        read_only=Fixed.PROTECTION,
    )
    watch_ratio: float = param(
        3.0,
        'ratio of the RMS of the vibration to that at 0 V, above which the law is checked as its '
        'possible cause',
        above=1.0,
        read_only=Fixed.PROTECTION,
    )

    @classmethod
    def own(cls) -> frozenset[str]:
        """Names of the settings that this schema adds to those that it builds on."""
        return frozenset(vars(cls).get('__annotations__', {}))

    def check_frequencies(self, *names: str) -> None:
        """Refuse frequencies (Hz) that are not below half the sample rate.

        Args:
            names: of parameters that hold one frequency or several.

        Raises:
            SatvibError: names the parameter.
        """
        nyquist = 0.5 * self.sample_rate
        for name in names:
            value = getattr(self, name)
            for frequency in value if isinstance(value, tuple) else (value,):
                if frequency >= nyquist:
                    raise SatvibError(
                        f'{name}: {frequency} Hz is not below half the sample rate, {nyquist} Hz'
                    )


@dataclass(frozen=True, kw_only=True)
class VelocityParameters(LawParameters):
    """The law `velocity_feedback`, and the velocity that `model_reference` and `centralized` use too."""

    velocity_gain: float = param(
        56.1,
        'gain of velocity_feedback, at most the bound that the model gives; the 550 of the paper, '
        'read as V per g s',
        unit='V/(m/s)',
        minimum=0.0,
    )
    velocity_fallback_gain: float = param(
        56.1,
        'largest gain of velocity_feedback while there is no identified model to bound it',
        unit='V/(m/s)',
        minimum=0.0,
    )
    velocity_corner: float = param(
        0.5,
        'corner of the drift-free integrator; its phase error at f is 2 atan(corner / f)',
        unit='Hz',
        above=0.0,
        read_only=Fixed.MEMORY,
    )
    velocity_polarity: float = param(
        1.0,
        'sign of acceleration per volt while there is no identified model',
        choices=(1.0, -1.0),
        read_only=Fixed.RIG,
    )

    def check(self) -> None:
        """Check the corner against the sample rate."""
        super().check()
        self.check_frequencies('velocity_corner')
