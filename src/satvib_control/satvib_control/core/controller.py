# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The controller of a strut: phases, calibration, excitation, law and guard around one sample.

| phase | voltage | what is learnt |
|---|---|---|
| STANDBY | 0 V | the law keeps its filters warm |
| CALIBRATE | 0 V | bias of both sensors |
| IDENTIFY | excitation | nothing here; the identifier watches |
| ADAPT | the law against its reference model | gains |
| CONTROL | the law, faded in | what the law wants |

Every voltage leaves through the guard. A missing upper sample gives 0 V for that sample; `loss_limit` of them in a
row latch a fault. A clipped sample is not learnt from; a sensor that clips for long takes the law off
(`clipping_watch`). A gap in the sequence is counted and the states stay. A sequence that goes back starts everything
again. What the coil got instead of the answer before, and a start in the middle of a run, are in `reception`.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Integers, Mask, every, some
from satvib_common.guard import Guarded, VoltageGuard
from satvib_common.phases import Phase, PhasePlan
from satvib_common.sequence import Arrival, SequenceTracker
from satvib_common.signals.calibration import BiasCalibration
from satvib_common.signals.statistics import MovingRms
from satvib_ident.models.iir_model import IirModel

from satvib_control.core.clipping_watch import ClippingWatch
from satvib_control.core.faults import STOPPED, Faults
from satvib_control.core.output import ControllerOutput
from satvib_control.core.reception import JOINED, LateStart, Measured, Received, Wish
from satvib_control.core.trusted_model import TrustedModel
from satvib_control.core.vibration_watch import Verdict, VibrationWatch
from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.reasons import reason, reasons
from satvib_control.laws.registry import make_law
from satvib_control.laws.strut_excitation import StrutSignals
from satvib_control.model_analysis.transfer import broadcast_model, model_polynomials, stable
from satvib_control.parameters import ControllerParameters
from satvib_control.supervision.hold import Hold

# phases in which no strut is excited on purpose
SILENT = (Phase.STANDBY, Phase.CALIBRATE)
# phases in which the law takes no model; tuples, because a set would ask each member for its hash on every sample
WITHOUT_MODEL = (Phase.CALIBRATE, Phase.IDENTIFY)
ACTING = (Phase.ADAPT, Phase.CONTROL)
LISTENING = reason('0 V: louder than the open loop, listening whether the law is the cause')
CLIPPED = reason('0 V: the upper sensor clips, so it cannot tell what the law does')
HELD = reason('0 V: held from outside, other struts are loud')
REDUCED = reason('the law made the strut louder than its open loop and goes on with less voltage')
UNSTABLE = reason('the identified model is not stable: not taken')
UNCAUSAL = reason('the identified model has no delay, so no law can use it: not taken')

__all__ = ['ControllerCore', 'ControllerOutput']

NONE = int(Verdict.NONE)
_AS_ASKED = Received()


class ControllerCore:
    """Decentralized controller of one strut, or of a batch of them.

    Args:
        parameters: see `ControllerParameters`.
        shape: leading axes; the last one, when there is one, counts struts from `parameters.strut`.
    """

    def __init__(self, parameters: ControllerParameters, shape: tuple[int, ...] = ()) -> None:
        p = parameters
        self.parameters, self.shape, self.dt = p, shape, 1.0 / p.sample_rate
        self._signals = StrutSignals(
            p.excitation, p.excitation_amplitude, p.excitation_frequencies, p, shape
        )
        self._dither = (
            StrutSignals(p.excitation, p.dither, p.excitation_frequencies, p, shape)
            if p.dither
            else None
        )
        self._tracker = SequenceTracker()
        self._begin()

    def _begin(self) -> None:
        p, shape = self.parameters, self.shape
        self.law = make_law(p.law, p, self.dt, shape)
        self.guard = VoltageGuard(p.voltage_limit, p.slew_limit or np.inf, self.dt, shape)
        self.calibration_upper = BiasCalibration(shape)
        self.calibration_lower = BiasCalibration(shape)
        self.watch = VibrationWatch(p, self.dt, shape)
        self.clipping = ClippingWatch(p.clipping_limit, self.dt, shape)
        self._hold = Hold(self.dt, shape)
        self._late = LateStart(self.dt, shape)
        self._plan: PhasePlan | None = None
        self._received = _AS_ASKED
        self._faults = Faults(shape)
        self._rms = MovingRms(max(round(p.rms_window * p.sample_rate), 1), shape)
        self._missed = 0
        self._zero = np.zeros(shape)
        self._nowhere = np.zeros(shape, dtype=bool)
        self._no_reason = np.zeros(shape, dtype=np.int64)
        self._saturated = np.zeros(shape, dtype=bool)
        self._fade = np.ones(shape)
        self._model_reason = np.zeros(shape, dtype=np.int64)
        self._waiting: tuple[IirModel, Mask, Array | None] | None = None
        self._given = TrustedModel(shape)
        self._checked_rest = False
        self._last: ControllerOutput | None = None

    def set_model(
        self,
        model: IirModel,
        trusted: ArrayLike = True,
        why: Any = '',
        covariance: Array | None = None,
    ) -> None:
        """Take the identified model; only at hand-over samples, before `step`.

        Args:
            model: shape, or one for all.
            trusted: shape, bool; where it is false the law keeps what it had.
            why: text, or texts (shape), why not.
            covariance: (*shape, n + m, n + m) of (a1..an, b1..bm).
        """
        model = broadcast_model(model, self.shape)
        b, a = model_polynomials(model)
        with np.errstate(all='ignore'):
            sound = (stable(a) > 0.0) & np.all(np.isfinite(b), axis=-1)
        trusted = np.broadcast_to(np.asarray(trusted, dtype=bool), self.shape)
        reported = reasons(why, self.shape)
        code = np.where(trusted, np.where(sound, 0, UNSTABLE), reported)
        if model.delay < 1:
            sound, code = np.zeros(self.shape, dtype=bool), np.where(trusted, UNCAUSAL, reported)
        self._model_reason = np.broadcast_to(code, self.shape)
        if covariance is not None:
            covariance = np.broadcast_to(covariance, (*self.shape, *covariance.shape[-2:]))
        use = self._given.news(model, np.asarray(trusted & sound))
        # a design costs, and most hand-overs after IDENTIFY bring nothing new
        self._waiting = (model, use, covariance) if use.any() else None

    @property
    def designs_wait(self) -> bool:
        """Whether a model waits for the first sample on which the law may take it."""
        return self._waiting is not None

    def prepare(self, phase: Phase) -> None:
        """Give the law the model that waits for it already now, before the next sample, which is of `phase`.

        That sample would begin with it, so no bit changes; but its voltage need not wait for a design of 1 or 2 ms. Not
        when `set_model` will still be called for that sample.
        """
        if phase not in WITHOUT_MODEL:
            self._hand_over_model()

    def apply(self, parameters: ControllerParameters) -> None:
        """Take new values of the parameters that are not read-only."""
        self.parameters = parameters
        self.guard.limit = parameters.voltage_limit
        self.law.apply(parameters)

    def effect_of(self, names: frozenset[str]) -> str:
        """Say what people should know about settings, by name, that were just applied; empty: they act as set."""
        law, known = self.law, bool(self._given.known.all())
        said = law.effect_of(names, known) if isinstance(law, BasicLaw) else ''
        return '; '.join(filter(None, (self.parameters.effect_of(names), said)))

    def stop(self, mask: Mask | bool = True, why: int = STOPPED) -> None:
        """Latch 0 V from the next sample on where `mask` (shape) holds, until `reset`; `why`: code of the reason."""
        self._faults.stop(mask, why)

    def hold(self, mask: Mask | bool = True) -> None:
        """Fade to 0 V where `mask` (shape) holds, until `release`, for 20 s at most; the law keeps what it knows."""
        self._hold.begin(mask)

    def release(self, mask: Mask | bool = True) -> None:
        """Let the law act again where `mask` (shape) holds."""
        self._hold.end(mask)

    def reset(self) -> bool:
        """Release latched faults; the law begins at rest. Biases and the identified model stay.

        Gives whether all were released: a bias that CALIBRATE did not give keeps its strut at 0 V.
        """
        self.guard.reset()
        self.law.reset()
        self.watch.reset()
        self.clipping.reset()
        self._hold.end()
        self._faults.reset()
        return not self._faults.biasless.any()

    def step(
        self,
        k: int,
        plan: PhasePlan,
        upper: ArrayLike,
        lower: ArrayLike,
        arrival: Arrival | None = None,
        upper_clipped: ArrayLike = False,
        lower_clipped: ArrayLike = False,
        received: Received | None = None,
    ) -> ControllerOutput:
        """Take sample k of both sensors (shape, m/s^2, as measured) and give the voltage.

        A repeated sample gives the answer that it got before.

        Args:
            k: sequence of the sample.
            plan: the phases.
            upper, lower: (shape) m/s^2 as measured; NaN: not measured.
            arrival: how k follows the sample before; None: it is found here.
            upper_clipped, lower_clipped: (shape) bool; the sensor stands at an end of its range.
            received: what the coils got before this sample; None: what was asked for.
        """
        if arrival is None:
            arrival = self._tracker.classify(k)
        if arrival is Arrival.REPEAT and self._last is not None:
            return self._last
        if arrival is Arrival.RESTART:
            self._begin()
        elif arrival is Arrival.GAP and self._last is not None:
            self._missed += k - self._last.sequence - 1
        phase = plan.at(k)
        if plan is not self._plan:  # the first sample, or the schedule came after some
            self._plan = plan
            self._late.begin(k, plan, bool(self.calibration_upper.count.any()))
        self._received = received or _AS_ASKED
        measured = self._without_bias(
            phase, np.asarray(upper, float), np.asarray(lower, float),
            self._mask(upper_clipped), self._mask(lower_clipped),
        )  # fmt: skip
        if phase not in WITHOUT_MODEL:
            self._hand_over_model()
        # in ADAPT the law shakes the strut on purpose
        acting, silent = phase == Phase.CONTROL, phase in SILENT
        if self._late.on:
            acting, silent = False, acting or silent
        elif self._received.withheld is not None:
            acting = acting and not every(self._received.withheld)
        applied = self.guard.voltage if self._received.voltage is None else self._received.voltage
        scale, verdict = self.watch.step(measured.upper, applied, acting, silent)
        free, begins, failed = self.clipping.step(measured.upper_clipped, phase == Phase.CONTROL)
        scale = scale * free * self._hold.step(self._received.withheld)
        begins = begins | (verdict != NONE)
        if some(begins):
            self.law.reset(begins)
        demand = self.law.step(self._law_input(k, measured, applied), phase)
        wish = self._wish(demand, scale, k, plan)
        guarded, why = self._guard(wish, measured, verdict, failed)
        self._last = ControllerOutput(
            sequence=k,
            phase=phase,
            law=self.parameters.law,
            voltage=guarded.voltage,
            output=wish.demand,
            saturated=guarded.saturated,
            fault=guarded.fault,
            state=self.law.state.copy(),
            reference=wish.reference,
            upper_rms=self._rms.add(measured.upper),
            bias_upper=self.calibration_upper.mean,
            bias_lower=self.calibration_lower.mean,
            adapting=wish.adapting,
            reason=why,
            missed_samples=self._missed,
        )
        return self._last

    def _mask(self, where: ArrayLike) -> Mask:
        """Give a mask of `shape`; that of most samples is made once."""
        if where is False:
            return self._nowhere
        mask = np.asarray(where, dtype=bool)
        return mask if mask.shape == self.shape else np.broadcast_to(mask, self.shape)

    def know_biases(self, upper: ArrayLike, lower: ArrayLike) -> None:
        """Take the biases (shape, m/s^2; NaN: not known) that another node has measured, for a late start."""
        self._late.give(upper, lower)

    def _without_bias(
        self, phase: Phase, upper: Array, lower: Array, upper_clipped: Mask, lower_clipped: Mask
    ) -> Measured:
        """Learn the biases in CALIBRATE, and take them away."""
        valid = np.isfinite(upper)
        whole = every(valid)
        if phase == Phase.CALIBRATE:
            if self._checked_rest and self._faults.biasless.any():
                self._calibrate_again()
            self.calibration_upper.add(np.where(upper_clipped, np.nan, upper))
            self.calibration_lower.add(np.where(lower_clipped, np.nan, lower))
        elif not self._checked_rest:
            self._checked_rest = True
            p, upper_bias = self.parameters, self.calibration_upper
            if not self._late.on:
                found = upper_bias.mean, upper_bias.standard_deviation
                self._faults.check_bias(*found, p.bias_limit, p.calibration_limit)
        if self._late.on:
            self._late.listen(upper, lower, self.calibration_upper, self.calibration_lower)
            if not self._late.on:
                self._hold.step(~self._nowhere)
        upper = upper - self.calibration_upper.mean
        if not whole:
            upper = np.where(valid, upper, 0.0)
        lower = lower - self.calibration_lower.mean
        if not every(np.isfinite(lower)):
            lower = np.where(np.isfinite(lower), lower, np.nan)
        return Measured(upper, lower, valid, upper_clipped & valid, lower_clipped, whole)

    def _calibrate_again(self) -> None:
        """Forget the biases of a CALIBRATE that failed somewhere, for this is another one."""
        self.calibration_upper.reset()
        self.calibration_lower.reset()
        self._checked_rest = False

    def _hand_over_model(self) -> None:
        """Give the law the model that waits for it."""
        if self._waiting is None:
            return
        model, use, covariance = self._waiting
        self.law.set_model(model, use, covariance)
        self._given.take(model, use)
        self._waiting = None

    def _law_input(self, k: int, measured: Measured, applied: Array) -> LawInput:
        # a law that is not let through must not learn from what it asks for
        frozen = self._saturated
        if self.watch.busy:
            frozen = frozen | self.watch.listening()
        if self.clipping.busy:
            frozen = frozen | self.clipping.paused
        if self._hold.busy:
            frozen = frozen | self._hold.held
        if self._received.changed is not None:
            frozen = frozen | self._received.changed
        return LawInput(
            sequence=k,
            upper=measured.upper,
            lower=measured.lower,
            applied=applied,
            saturated=frozen,
            valid=measured.valid,
            fade=self._fade,
            upper_clipped=measured.upper_clipped,
            lower_clipped=measured.lower_clipped,
        )

    def _wish(self, demand: Array, scale: Array, k: int, plan: PhasePlan) -> Wish:
        """What the phase makes of the law's demand (shape, V)."""
        phase, state = plan.at(k), self.law.state
        if phase not in ACTING:
            self._fade = signal = self._zero
            if phase == Phase.IDENTIFY:
                signal = self.parameters.excitation_share * self._signals.at(k - plan.start_of(k))
            return Wish(signal, signal, self._nowhere, self._no_reason)
        self._fade = scale * self._fade_in(k, plan, phase)
        why = state.reason
        if self.law.needs_model:
            why = np.where(self._model_reason != 0, self._model_reason, why)
        if self.watch.busy:
            why = np.where(self.watch.reduced(), REDUCED, why)
            why = np.where(self.watch.listening(), LISTENING, why)
        if self.clipping.busy:
            why = np.where(self.clipping.paused, CLIPPED, why)
        if self._hold.busy:
            why = np.where(self._hold.held, HELD, why)
        if self._late.on:
            self._fade, why = self._zero, np.full(self.shape, JOINED)
        voltage = demand * self._fade
        if self._dither is not None and phase == Phase.CONTROL:
            voltage = voltage + self._dither.at(k - plan.start_of(k)) * self._fade
        return Wish(voltage, state.reference, state.adapting, why)

    def _guard(
        self, wish: Wish, measured: Measured, verdict: Integers, failed: Mask
    ) -> tuple[Guarded, Integers]:
        """Let the wish through the guard; give what came out and the reasons (shape)."""
        valid, whole = measured.valid, measured.whole
        alarmed = self._faults.alarmed or some(verdict != NONE) or some(failed) or not whole
        stop = self._causes(valid, verdict, failed) if alarmed else None
        demand = wish.demand if whole else np.where(valid, wish.demand, 0.0)
        guarded = self.guard.apply(demand, False if stop is None else stop != 0)
        self._saturated = guarded.saturated
        why = wish.reason
        if self._received.reason is not None:
            why = np.where(self._received.reason != 0, self._received.reason, why)
        if alarmed or some(guarded.fault):
            return guarded, self._faults.explain(guarded, valid, why, stop)
        return guarded, why

    def _fade_in(self, k: int, plan: PhasePlan, phase: Phase) -> float:
        """Share of the law's voltage while CONTROL begins."""
        p = self.parameters
        if phase != Phase.CONTROL:
            return 1.0
        return min((k - plan.start_of(k) + 1) / max(p.switch_on_time * p.sample_rate, 1.0), 1.0)

    def _causes(self, valid: Mask, verdict: Integers, blind: Mask) -> Integers:
        """What stops the voltage for good, as codes (shape); 0 for nothing."""
        return self._faults.causes(valid, verdict, blind, self.parameters.loss_limit)
