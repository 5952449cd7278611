# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Feedforward from the lower accelerometer: what comes in is cancelled before it reaches the payload.

"The bottom accelerometer measures the incoming vibration for feedforward control": the paper says no more. Its
references 11-13 use filtered-x. For each sample k:

    x     = x_m - F_hat u                     reference without the strut's own reaction  (reaction)
    phi   = taps of x, its integrals, past u  regressor; phi_f = G_hat phi                (regressor)
    d_hat = y - G_hat u_applied               what the payload would do without the voltage
    e     = d_hat + w^T phi_f                 what the present weights would leave
    w     <- by fxlms, fxrls or filtered_u    G_hat: the identified model
    u     = w^T phi

d_hat and e contain the voltage that the guard let out, so saturation, fading and the other laws of a sum do not change
the gradient. While the voltage is saturated nothing is learnt and the weights shrink, until the coil can give what the
law asks for. The voltage is 0 without a trusted model, without the lower sensor, until its history is complete, and in
most states of `backoff`. The reason in the state says which.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.phases import Phase

from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.feedforward.backoff import Backoff
from satvib_control.laws.feedforward.fxrls import LeastSquares
from satvib_control.laws.feedforward.parameters import FeedforwardParameters
from satvib_control.laws.feedforward.reaction import ReferenceProtection
from satvib_control.laws.feedforward.regressor import FilteredReference
from satvib_control.laws.feedforward.regressor_kernel import Contents
from satvib_control.laws.feedforward.spikes import hold_of, spike_memory
from satvib_control.laws.feedforward.step import Given, Setting, Shown, Slot, feedforward_step
from satvib_control.laws.reasons import reason

if TYPE_CHECKING:
    from satvib_ident.models.iir_model import IirModel

NO_MODEL = reason('no trusted identified model: 0 V')
MISSING = reason('feedforward: the lower acceleration is missing: 0 V')
FILLING = reason('feedforward: the history of the lower acceleration is not complete: 0 V')
LISTENING = reason('feedforward: listening to the vibration without control: 0 V')
BACKED_OFF = reason('feedforward: backed off, the error had grown')
GAVE_UP = reason('feedforward: given up, the error grew again and again: 0 V')
SMALL = reason('feedforward: adaptation frozen: the reference is too small')
SATURATED = reason('adaptation frozen: the voltage is saturated')
CLIPPED = reason('feedforward: adaptation frozen: a sensor clips at its range')

_CODES = np.array(
    [0, SATURATED, SMALL, CLIPPED, LISTENING, BACKED_OFF, FILLING, MISSING, GAVE_UP, NO_MODEL]
)  # by `Why`

RAIL_TIME = 0.05  # s, time constant with which the weights shrink while saturated
ACTING = (Phase.ADAPT, Phase.CONTROL)


class Feedforward(BasicLaw[FeedforwardParameters]):
    """u = w^T phi; see the module's page.

    Attributes:
        weights: (*shape, p) V/(m/s^2) in the order of the regressor.
        protection: what is known of the reaction.
    """

    needs_model = True
    settings = FeedforwardParameters.own()
    closes_loop = False
    cancels = True

    def __init__(
        self, parameters: FeedforwardParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        p = parameters
        self.protection = ReferenceProtection(round(p.feedforward_protection_time / dt), shape)
        poles = p.feedforward_poles if p.feedforward_method == 'filtered_u' else 0
        contents = Contents(p.feedforward_taps, int(p.feedforward_motion), poles)
        self.reference = FilteredReference(
            contents, p.feedforward_motion_corner, self.protection.taps, dt, shape
        )
        self.weights = np.zeros((*shape, contents.size))
        self._power = np.zeros((*shape, 1))  # of fxlms
        size = 0 if p.feedforward_method == 'fxlms' else contents.size
        self._least_squares = LeastSquares(size, shape)
        self._spikes = spike_memory(shape)
        self.backoff = Backoff(shape)
        self._memory = np.zeros((*shape, len(Slot)))
        self._memory[..., Slot.BOOST] = 1.0
        self._given, self._settings = np.zeros(len(Given)), np.zeros(len(Setting))
        self._shown, self._zero = np.zeros((*shape, len(Shown))), np.zeros(shape)
        self._phase, self._sequence = Phase.STANDBY, -1
        self.state.reason = np.full(shape, NO_MODEL)
        self.apply(p)

    def apply(self, parameters: FeedforwardParameters) -> None:
        """Take new settings; those that shape the filter are read-only."""
        super().apply(parameters)
        p = parameters
        squares, others = p.feedforward_method != 'fxlms', p.feedforward_struts - 1
        self._settings[:] = (
            self.dt,
            p.feedforward_floor,
            hold_of(p.feedforward_taps, self.dt),
            self.reference.settle,
            p.feedforward_step,
            p.feedforward_leak,
            -math.expm1(-self.dt / p.feedforward_memory),
            squares,
            p.feedforward_weight_limit,
            1.0 - min(self.dt / RAIL_TIME, 1.0),
            others if self.protection.taps else 0,
            1.0 / p.feedforward_leak if p.feedforward_leak else math.inf,
        )
        window = max(round(p.watch_time / self.dt), 1)
        self.backoff.tune(window, p.watch_ratio, p.feedforward_floor)

    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:  # noqa: ARG002
        """Take the secondary path where it is trusted; the voltage does not jump."""
        fresh = self.reference.set_model(model, trusted, self.protection.reaction, self.weights)
        if fresh is not None:
            self.backoff.forgive(fresh)

    def step(self, x: LawInput, phase: Phase) -> Array:
        """Give the voltage (shape, V)."""
        acting, acted = phase in ACTING, self._phase in ACTING
        lost = max(x.sequence - self._sequence - 1, 0) if self._sequence >= 0 else 0
        alone = phase is not Phase.IDENTIFY and self._phase is not Phase.IDENTIFY
        if not alone:
            self._learn_reaction(x, phase)
        self._phase, self._sequence = phase, x.sequence
        self._given[:] = acting, acted, alone, lost
        r, protection, squares = self.reference, self.protection, self._least_squares
        demand = feedforward_step(
            x.upper, x.lower, x.applied, x.fade, x.saturated, x.valid, x.upper_clipped,
            x.lower_clipped, r.known, self._given, self._settings, self.backoff.settings,
            protection.reaction, protection.magnitude, r.table, r.num, r.den, r.coefficients,
            r.sizes, self.weights, *r.state, r.sensor, self._spikes, self.backoff.memory,
            self._power, squares.U, squares.d, squares.memory, self._memory, self._shown,
        )  # fmt: skip
        shown = self._shown.copy()
        r.remember(shown[..., Shown.USUAL], x.applied, x.applied if acted else self._zero)
        state = self.state
        state.reference, state.model_output = (
            shown[..., Shown.REFERENCE],
            shown[..., Shown.PREDICTED],
        )
        state.error, state.weight_norm = x.upper, shown[..., Shown.NORM]
        state.adapting = shown[..., Shown.ADAPTING] > 0.0
        state.reason = _CODES[shown[..., Shown.WHY].astype(np.int64)]
        return np.asarray(demand)

    def _learn_reaction(self, x: LawInput, phase: Phase) -> None:
        """In IDENTIFY learn what the voltage does to the lower sensor; use it from the sample after on."""
        r, protection = self.reference, self.protection
        protection.learn(r.last(x.lower), x.applied, np.isfinite(x.lower))
        if phase is not Phase.IDENTIFY:
            protection.finish()
            r.set_reaction(protection.reaction, self.weights)

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget weights and filters; the identified model and the learnt reaction stay."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)
        self.reference.reset(pick)
        self.backoff.reset(pick)
        self._forget_power(pick)
        self.weights[...] = np.where(pick[..., None], 0.0, self.weights)
        boost, demand = self._memory[..., Slot.BOOST], self._memory[..., Slot.DEMAND]
        boost[...] = np.where(pick, 1.0, boost)
        demand[...] = np.where(pick, 0.0, demand)

    def _forget_power(self, mask: Mask) -> None:
        """Let the adaptation begin again with the next sample where `mask` holds."""
        self._power[...] = np.where(mask[..., None], 0.0, self._power)
        self._least_squares.reset(mask)
