# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""From accelerations and voltages to a model, sample by sample: the mathematics of `strut_identifier`.

Each sample: find out whether it follows the last one; learn the sensor's bias in CALIBRATE; form the regressor of
Eq. (32); update the estimate where the phase, the regressor and the input allow it; then judge whether the model may
be believed.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from satvib_common.calibration import BiasCalibration
from satvib_common.phases import Phase
from satvib_common.sequence import Arrival, SequenceTracker

from satvib_ident.estimators import make_estimator
from satvib_ident.iir_model import IirModel
from satvib_ident.parameters import IdentifierParameters
from satvib_ident.regressor import IirRegressor

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Identification:
    """What is known after one sample; arrays of `shape` unless said otherwise.

    Attributes:
        sequence: index of the sample.
        a: (*shape, n).
        b: (*shape, m), m/s^2/V.
        delay: samples.
        dt: s.
        covariance: (*shape, p, p); NaN while unknown.
        standard_deviation: (*shape, p); NaN while unknown.
        prediction_error: m/s^2; NaN where this sample was not used.
        noise_variance: m^2/s^4; NaN while unknown.
        bias: m/s^2, taken off the upper sensor.
        updates: samples used.
        excitation_order: order of persistent excitation of the input.
        information_eigenvalue: smallest eigenvalue of the normalized information matrix.
        information_condition: its condition number.
        whiteness: Ljung-Box statistic over its degrees of freedom.
        pole_modulus: largest modulus of the poles.
        converged: the model may be believed.
        reasons: why not, object array of str; '' where it may.
    """

    sequence: int
    a: Array
    b: Array
    delay: int
    dt: float
    covariance: Array
    standard_deviation: Array
    prediction_error: Array
    noise_variance: Array
    bias: Array
    updates: Array
    excitation_order: NDArray[np.int64]
    information_eigenvalue: Array
    information_condition: Array
    whiteness: Array
    pole_modulus: Array
    converged: Mask
    reasons: NDArray[np.object_]

    def model(self) -> IirModel:
        """The model, as a batch of `shape`."""
        return IirModel(self.a, self.b, self.delay, self.dt)

    @property
    def reason(self) -> str:
        """Why the model of a single strut may not be believed; of a batch, the first reason."""
        return next((str(r) for r in self.reasons.ravel() if r), '')


class IdentifierCore:
    """Identifiers of a batch of struts, in step.

    Args:
        parameters: settings, the same for every item.
        shape: leading axes; () in a node.

    Attributes:
        counters: for diagnostics: lost samples, repeats, restarts, and per item samples that were not finite, samples
            whose voltage was not known, updates refused.
    """

    def __init__(self, parameters: IdentifierParameters, shape: tuple[int, ...] = ()) -> None:
        self.parameters, self.shape = parameters, shape
        self.regressor = IirRegressor(
            parameters.poles, parameters.coefficients, parameters.delay, shape
        )
        self.estimator = make_estimator(parameters, shape)
        self.calibration = BiasCalibration(shape)
        self.tracker = SequenceTracker()
        self._phases = frozenset(Phase[name] for name in parameters.estimate_in)
        self._phase = Phase.STANDBY
        self._bias = np.zeros(shape)
        self._not_finite = np.zeros(shape)
        self._unknown = np.zeros(shape)
        self._last: Identification | None = None

    @property
    def counters(self) -> dict[str, Array | int]:
        """Events so far, by name."""
        return {
            'lost samples': self.tracker.lost,
            'repeated samples': self.tracker.repeats,
            'restarts of the source': self.tracker.restarts,
            'accelerations not finite': self._not_finite,
            'voltages not known': self._unknown,
            'updates refused': self.estimator.refused,
        }

    def step(self, k: int, phase: Phase, upper: Array, voltage: Array) -> Identification:
        """Take one sample.

        Args:
            k: sequence of the sample.
            phase: the phase of that sample.
            upper: (shape) y(k), m/s^2 as measured; NaN: not measured.
            voltage: (shape) u(k - delay), V, as the guard let it out; NaN: not known.

        Returns:
            What is known now. A repeated sample changes nothing and gives the last answer again.
        """
        upper, voltage = np.asarray(upper, dtype=float), np.asarray(voltage, dtype=float)
        arrival = self.tracker.see(k)
        if arrival is Arrival.REPEAT and self._last is not None:
            return self._last
        if arrival is Arrival.RESTART:
            self.reset()
        elif arrival is Arrival.GAP:
            self.regressor.clear()
            self.estimator.interrupt()
        finite = np.isfinite(upper)
        self._not_finite = self._not_finite + ~finite
        self._unknown = self._unknown + ~np.isfinite(voltage)
        self._calibrate(phase, upper)
        w, full = self.regressor.form(voltage, self._bias)
        y = np.where(finite, upper - self._bias, 0.0)
        active = full & finite & (phase in self._phases) & self._excited(w)
        error = self.estimator.update(w, y, active)
        self.regressor.take(np.where(finite, upper, np.nan))
        self._last = self._report(k, np.where(active, error, np.nan))
        return self._last

    def reset(self) -> None:
        """Forget everything but the counts."""
        self.regressor.clear()
        self.estimator.reset()
        self.calibration.reset()
        self._bias = np.zeros(self.shape)
        self._phase = Phase.STANDBY

    def _calibrate(self, phase: Phase, upper: Array) -> None:
        if self.parameters.bias == 'calibrate' and phase is Phase.CALIBRATE:
            if self._phase is not Phase.CALIBRATE:
                self.calibration.reset()
            self.calibration.add(upper)
            self._bias = self.calibration.mean
        self._phase = phase

    def _excited(self, w: Array) -> Mask:
        drive = np.abs(w[..., self.parameters.poles :])
        return np.asarray(np.maximum.reduce(drive, axis=-1) > self.parameters.input_floor)

    def _report(self, k: int, error: Array) -> Identification:
        n = self.parameters.poles
        theta = self.estimator.theta[..., : self.parameters.count].copy()
        count = self.parameters.count
        covariance = self.estimator.covariance[..., :count, :count]
        diagonal = np.einsum('...ii->...i', covariance)
        model = IirModel(theta[..., :n], theta[..., n:], self.parameters.delay, self.parameters.dt)
        nan = np.full(self.shape, np.nan)
        modulus = model.pole_modulus()
        few = self.estimator.updates < 10 * count
        reasons = np.where(
            few, 'too few samples', np.where(modulus < 1.0, '', 'the model is unstable')
        ).astype(object)
        return Identification(
            k,
            model.a,
            model.b,
            model.delay,
            model.dt,
            covariance,
            np.sqrt(diagonal),
            error,
            self.estimator.noise_variance,
            self._bias,
            self.estimator.updates,
            np.zeros(self.shape, dtype=np.int64),
            nan,
            nan,
            nan,
            modulus,
            ~few & (modulus < 1.0),
            reasons,
        )
