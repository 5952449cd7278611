# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""From accelerations and voltages to a model, sample by sample: the mathematics of `strut_identifier`.

For each sample: check how it follows the last one; measure the sensor's bias and noise in CALIBRATE; form the regressor
of Eq. (32); update the estimate where the phase, the regressor and the input allow it; check whether the model is
trusted.

In samples of noise alone y(k) does not depend on y(k-1). A rule that forgets older samples would follow them, and a
would drift to 0. Two conditions keep such samples out. The voltage must have been excited within `input_hold`. And the
regressor must be longer than noise alone makes it: with s the deviation of the sensor at rest, |w|^2 / s^2 is
chi-squared with n degrees of freedom, and the floor is its quantile for one sample in a million. s is estimated from N
samples, so its upper limit with 99.9 % confidence is used.
"""

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from satvib_common.arrays import Array, Mask, every, some
from satvib_common.kernels.ordered_dot import dot
from satvib_common.phases import Phase
from satvib_common.sequence import Arrival, SequenceTracker
from satvib_common.signals.calibration import BiasCalibration
from satvib_common.special import chi_squared_above

from satvib_ident.estimators.factory import make_estimator, make_regressor
from satvib_ident.models.iir_model import IirModel
from satvib_ident.models.polynomials import pole_modulus
from satvib_ident.parameters import IdentifierParameters
from satvib_ident.signal_units import SignalUnits
from satvib_ident.trust.checks import Trust, judge
from satvib_ident.trust.measures import RecentSignal
from satvib_ident.trust.model_error import ModelError
from satvib_ident.trust.response_deviation import ResponseDeviation

BY_CHANCE = 1e-6  # share of the samples of noise alone that pass the floor of the regressor
CONFIDENCE = 0.999
ENOUGH = 20  # samples of CALIBRATE from which the noise is known


@dataclass(frozen=True, eq=False)
class Identification:
    """What is known after one sample; arrays of `shape` unless stated otherwise.

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
        response_deviation: largest relative deviation of the frequency response in the band of interest.
        model_error: largest relative error of that response that the residual shows.
        pole_modulus: largest modulus of the poles.
        converged: the model is trusted.
        trust: the checks behind `converged`, with reasons.
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
    excitation_order: Array
    information_eigenvalue: Array
    information_condition: Array
    response_deviation: Array
    model_error: Array
    whiteness: Array
    pole_modulus: Array
    converged: Mask
    trust: Trust

    def model(self) -> IirModel:
        """The model, as a batch of `shape`."""
        return IirModel(self.a, self.b, self.delay, self.dt)

    def figures(self) -> dict[str, Any]:
        """Every figure of an item, by the name of its field in satvib_msgs/IirParameters; arrays of `shape`.

        The node's message and the twin's recording are filled from this one list.
        """
        return {name: getattr(self, name) for name in FIGURES} | {'reason': self.reasons}

    @property
    def reasons(self) -> NDArray[np.object_]:
        """Why each item is not trusted, object array (shape) of str; '' where it is."""
        return self.trust.reasons

    @property
    def reason(self) -> str:
        """Why the model of a single strut is not trusted; of a batch, the first reason."""
        failed = np.argwhere(self.trust.failed)
        return self.trust.reason(tuple(failed[0])) if len(failed) else ''


# what all items have in common is none of these
FIGURES = tuple(
    f.name for f in fields(Identification) if f.name not in {'sequence', 'delay', 'dt', 'trust'}
)


class IdentifierCore:
    """Identifiers of a batch of struts, in step.

    Args:
        parameters: settings, the same for every item.
        shape: leading axes; () in a node.

    Attributes:
        counters: for diagnostics: lost samples, repeats, restarts, and per item samples that were not finite or
            clipped, samples whose voltage was not known or whose regressor was too short, updates refused.
    """

    def __init__(self, parameters: IdentifierParameters, shape: tuple[int, ...] = ()) -> None:
        self.parameters, self.shape = parameters, shape
        self.regressor = make_regressor(parameters, shape)
        self.estimator = make_estimator(parameters, shape)
        self.calibration = BiasCalibration(shape)
        self.tracker = SequenceTracker()
        self._units = SignalUnits(shape)
        self._may_scale = not parameters.initial_theta  # a start is in m/s^2 and V
        self._phases = frozenset(Phase[name] for name in parameters.estimate_in)
        self._response = ResponseDeviation(
            (parameters.trust_band[0], parameters.trust_band[1]),
            parameters.dt,
            parameters.poles,
            parameters.coefficients,
        )
        rate = parameters.sample_rate
        window = max(parameters.measure_window or round(2.0 * rate), 20)
        self._period = parameters.measure_period or max(round(0.05 * rate), 1)
        self._input = RecentSignal(window, shape)
        self._model_error = ModelError(
            self._response.frequencies,
            parameters.dt,
            parameters.poles,
            parameters.coefficients,
            window,
            parameters.error_lags or min(max(round(0.2 * rate), 10), 100),
            shape,
        )
        self._residual = RecentSignal(window, shape)
        self._hold = round(parameters.input_hold * rate)
        self._nobody = np.zeros(shape, dtype=bool)
        self._not_finite = np.zeros(shape)
        self._clipped = np.zeros(shape)
        self._short = np.zeros(shape)
        self._unknown = np.zeros(shape)
        self._begin()

    def _begin(self) -> None:
        self._phase = Phase.STANDBY
        self._bias = np.zeros(self.shape)
        self._units.reset()
        self._know_noise()
        self._silent = np.full(self.shape, np.inf)
        self._last: Identification | None = None
        self._measured: Trust | None = None

    @property
    def counters(self) -> dict[str, Array | int]:
        """Events so far, by name."""
        return {
            'lost samples': self.tracker.lost,
            'repeated samples': self.tracker.repeats,
            'restarts of the source': self.tracker.restarts,
            'accelerations not finite': self._not_finite,
            'accelerations clipped': self._clipped,
            'voltages not known': self._unknown,
            'regressors below the floor': self._short,
            'updates refused': self.estimator.refused,
        }

    def step(
        self,
        k: int,
        phase: Phase,
        upper: Array,
        voltage: Array,
        arrival: Arrival | None = None,
        clipped: ArrayLike = False,
    ) -> Identification:
        """Take one sample.

        Args:
            k: sequence of the sample.
            phase: the phase of that sample.
            upper: (shape) y(k), m/s^2 as measured; NaN: not measured.
            voltage: (shape) u(k - delay), V, as the guard let it out; NaN: not known.
            arrival: how k follows the sample before; None: it is found here.
            clipped: (shape) bool; y(k) stands at an end of the sensor's range, and is left out as one not measured.

        Returns:
            What is known now. A repeated sample changes nothing and gives the last answer again.
        """
        upper, voltage = np.asarray(upper, dtype=float), np.asarray(voltage, dtype=float)
        if arrival is None:
            arrival = self.tracker.classify(k)
        if arrival is Arrival.REPEAT and self._last is not None:
            return self._last
        if arrival is Arrival.RESTART:
            self.reset()
        elif arrival is Arrival.GAP:
            self.regressor.clear()
        finite = np.isfinite(upper)
        self._not_finite = self._not_finite + ~finite
        if clipped is not False and some(at_end := np.asarray(clipped, dtype=bool)):
            self._clipped = self._clipped + at_end
            upper = np.where(at_end, np.nan, upper)
        self._unknown = self._unknown + ~np.isfinite(voltage)
        self._calibrate(phase, upper)
        if not self._units.settled and phase in self._phases and self._may_scale:
            self._rescale(self._units.watch(upper - self._bias, voltage))
        bias = self._bias
        if not self._units.are_one:
            bias, upper = bias / self._units.output, upper / self._units.output
            voltage = voltage / self._units.input
        w, target, full = self.regressor.step(upper, voltage, bias)
        if not every(full):
            self.estimator.interrupt(~full)
            for recent in (self._residual, self._input, self._model_error):
                recent.clear(~full)
        active = full & self._excited(voltage) & (phase in self._phases)
        if self._gated:
            long = dot(w, w) >= self._floor
            self._short = self._short + (active & ~long)
            active = active & long
        working = some(active)
        if not (working or self.estimator.keeps_signals):
            self._last = self._report(k, np.full(self.shape, np.nan), self._nobody)
            return self._last
        error = self.estimator.update(w, target, active)
        used = self.estimator.used
        if some(used):
            self._input.push(voltage, used)
            self._model_error.push(upper - bias, voltage, used)
            self._residual.push(np.where(used, error, 0.0), used)
        error = np.where(used, error, np.nan)
        self._last = self._report(
            k, error if self._units.are_one else error * self._units.output, active
        )
        return self._last

    def _rescale(self, changed: Mask) -> None:
        """Begin again with other units where they have changed (shape)."""
        if not changed.any():
            return
        self.regressor.clear(changed)
        self.estimator.reset(changed)
        self.estimator.interrupt(changed)
        for recent in (self._residual, self._input, self._model_error):
            recent.clear(changed)
        self._know_noise()

    def know_bias(self, bias: Array) -> None:
        """Take the bias of the upper sensor (shape, m/s^2) as another node has measured it in CALIBRATE."""
        if self.parameters.bias == 'calibrate':
            self._bias = np.broadcast_to(np.asarray(bias, dtype=float), self.shape)

    def reset(self) -> None:
        """Forget everything except the counts."""
        self.regressor.clear()
        self.estimator.reset()
        self.calibration.reset()
        self._input.clear()
        self._residual.clear()
        self._model_error.clear()
        self._begin()

    def _calibrate(self, phase: Phase, upper: Array) -> None:
        if self.parameters.bias == 'calibrate' and phase is Phase.CALIBRATE:
            if self._phase is not Phase.CALIBRATE:
                self.calibration.reset()
            self.calibration.add(upper)
            self._bias = self.calibration.mean
        elif self._phase is Phase.CALIBRATE and self.parameters.floor_from_noise:
            self._know_noise()
        self._phase = phase

    def _know_noise(self) -> None:
        """Set the floors that follow from the noise of the sensor at rest, as far as CALIBRATE has measured it."""
        count = self.calibration.count
        known = (count >= ENOUGH) & self.parameters.floor_from_noise
        deviation = np.where(known, self.calibration.standard_deviation, 0.0)
        deviation = deviation / self._units.output
        freedom = np.maximum(count, ENOUGH) - 1.0
        upper = deviation * np.sqrt(freedom / chi_squared_above(freedom, CONFIDENCE))
        floor = upper * np.sqrt(chi_squared_above(self.parameters.poles, BY_CHANCE))
        floor = np.maximum(floor, self.parameters.regressor_floor)
        self.estimator.forgetting.know_noise(deviation)
        self._floor = floor * floor
        self._gated = bool((floor > 0.0).any())

    def _excited(self, voltage: Array) -> Mask:
        """Whether the input was excited within the hold time; later samples hold noise alone."""
        loud = np.abs(voltage) > self.parameters.input_floor
        self._silent = np.where(loud, 0.0, self._silent + 1.0)
        return np.asarray(self._silent <= self._hold)

    def _report(self, k: int, error: Array, active: Mask) -> Identification:
        p, estimator, last = self.parameters, self.estimator, self._last
        if last is not None and not some(active):
            return replace(last, sequence=k, prediction_error=error, bias=self._bias)
        theta, covariance = self.regressor.model(estimator.theta, estimator.covariance)
        if self._measured is None or k % self._period == self._period - 1:
            fresh, known = self._measure(theta, covariance), self._measured
            # an item that did not use this sample keeps what it had, whatever the other items do
            self._measured = fresh if known is None else known.renewed(fresh, active)
        v, noise = self._measured, estimator.noise_variance
        if not self._units.are_one:
            units = self._units.of_parameters(p.poles, p.count)
            theta, covariance = theta * units, covariance * units[..., None] * units[..., None, :]
            noise = noise * self._units.output**2
        diagonal = np.diagonal(covariance, axis1=-2, axis2=-1)
        return Identification(
            sequence=k,
            a=theta[..., : p.poles],
            b=theta[..., p.poles :],
            delay=p.delay,
            dt=p.dt,
            covariance=covariance,
            standard_deviation=np.sqrt(diagonal),
            prediction_error=error,
            noise_variance=noise,
            bias=self._bias,
            updates=estimator.updates,
            excitation_order=v.excitation_order,
            information_eigenvalue=v.information_eigenvalue,
            information_condition=v.information_condition,
            response_deviation=v.response_deviation,
            model_error=v.model_error,
            whiteness=v.whiteness,
            pole_modulus=v.pole_modulus,
            converged=v.converged,
            trust=v,
        )

    def _measure(self, theta: Array, covariance: Array) -> Trust:
        p = self.parameters
        return judge(
            p,
            updates=self.estimator.updates,
            theta=theta,
            pole_modulus=np.asarray(pole_modulus(theta[..., : p.poles])),
            excitation_order=self._input.excitation_order(p.count + 5),
            information=self.estimator.information(),
            response_deviation=self._response(theta, covariance),
            model_error=self._model_error(theta),
            whiteness=self._residual.whiteness(p.whiteness_lags),
        )
