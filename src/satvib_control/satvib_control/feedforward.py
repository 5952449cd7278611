# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Feedforward from the lower accelerometer: what comes in is cancelled before it has passed.

"The bottom accelerometer measures the incoming vibration for feedforward control" is all that the paper says; its
references 11-13 are the filtered-x school. Per sample k, each part in a file of its own:

    x     = x_m - F_hat u                     reference without the strut's own reaction  (reference_protection)
    phi   = taps of x, its integrals, past u  regressor; phi_f = G_hat phi                (reference_line)
    d_hat = y - G_hat u_applied               what the payload would do without the voltage
    e     = d_hat + w^T phi_f                 what the present weights would leave
    w     <- by fxlms, fxrls or filtered_u    G_hat: the identified model
    u     = w^T phi

d_hat and e are formed with the voltage that the guard really let out: saturation, fading in and the other laws of a sum
do not disturb the gradient. While saturated nothing is learnt and the weights shrink, so that the demand comes down to
what the coil can do. The voltage is 0, and the state says why, without a trusted model, without the lower sensor, until
its history is complete again, while the law listens (error_watch), and after it has given up.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from satvib_common.phases import Phase

from satvib_control.error_watch import (
    COUNT,
    FADE,
    GIVEN_UP,
    LEARN,
    LISTEN,
    PACE,
    RESTART,
    SHARE,
    SIZE,
    watch,
)
from satvib_control.filtered_u import stabilize
from satvib_control.fxlms import fxlms
from satvib_control.fxrls import fxrls
from satvib_control.law import Array, BasicLaw, LawInput, Mask
from satvib_control.reasons import reason
from satvib_control.reference_line import (
    MOTION,
    count,
    inner,
    line_table,
    motion_coefficients,
    run_line,
)
from satvib_control.reference_protection import FREQUENCIES, ReferenceProtection, loop_gain

if TYPE_CHECKING:
    from satvib_ident.iir_model import IirModel

    from satvib_control.parameters import ControllerParameters

NO_MODEL = reason('no trusted identified model: 0 V')
MISSING = reason('feedforward: the lower acceleration is missing: 0 V')
FILLING = reason('feedforward: the history of the lower acceleration is not complete: 0 V')
LISTENING = reason('feedforward: listening to the vibration without control: 0 V')
BACKED_OFF = reason('feedforward: backed off, the error had grown')
GAVE_UP = reason('feedforward: given up, the error grew again and again: 0 V')
SMALL = reason('feedforward: adaptation frozen: the reference is too small')
SATURATED = reason('adaptation frozen: the voltage is saturated')

HISTORY = 2.0  # s of samples through which a new model is run, so that it finds its filters warm
SHORT_GAP = 3  # samples that may be missing without spoiling the integrals
POLE_RADIUS = 0.99
CUT = 1e-6  # V; less is rounding
LOOP_GAIN = 1.0  # |(n - 1) W F_hat| of n struts on one plate; small gain
BOOST = 1.05  # by which the leak rises per sample above it
RAIL_TIME = 0.05  # s, time constant with which the weights shrink while saturated


class Feedforward(BasicLaw):
    """u = w^T phi; see the module's page."""

    needs_model = True
    cancels = True

    def __init__(
        self, parameters: 'ControllerParameters', dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        p = parameters
        self._poles = p.feedforward_poles if p.feedforward_method == 'filtered_u' else 0
        self._sizes = np.array([p.feedforward_taps, int(p.feedforward_motion), self._poles])
        size = count(p.feedforward_taps, p.feedforward_motion, self._poles)
        self._coefficients = motion_coefficients(p.feedforward_motion_corner, dt)
        self._table = line_table(
            p.feedforward_taps, p.feedforward_motion, self._poles, p.feedforward_motion_corner, dt,
            FREQUENCIES,
        )  # fmt: skip
        self._boost = np.ones(shape)
        self._settle = 3.0 / (2.0 * math.pi * p.feedforward_motion_corner * dt)
        self._settle = math.ceil(self._settle) if p.feedforward_motion else 0
        self.protection = ReferenceProtection(round(p.feedforward_protection_time / dt), shape)
        self.weights = np.zeros((*shape, size))
        rows = 3 if self._poles else 2
        self._lines = np.zeros((*shape, rows, size))
        self._motion = np.zeros((*shape, rows, MOTION))
        self._before = np.zeros((*shape, 2))
        self._voltages = np.zeros((*shape, max(self.protection.taps, 1)))
        self._room(2)
        self._power = np.zeros((*shape, 2))
        self._U = np.zeros((*shape, size, size))
        self._d = np.zeros((*shape, size))
        self._watch = np.zeros((*shape, SIZE))
        self._watch[..., PACE] = 1.0
        depth = max(round(HISTORY / dt), 1)
        self._past = np.zeros((3, depth, *shape))  # lower, applied, own
        self._next = 0
        self._known = np.zeros(shape, dtype=bool)
        self._last = np.zeros(shape)  # lower acceleration, the newest that was measured
        self._missing = np.zeros(shape)
        self._need = np.full(shape, float(p.feedforward_taps + self._settle))
        self._phase = Phase.STANDBY
        self._demand = np.zeros(shape)
        self.state.reason = np.full(shape, NO_MODEL)
        self._tune()

    def _tune(self) -> None:
        """Take what may be changed while running."""
        p, dt = self.parameters, self.dt
        self._settings = np.zeros((*self.shape, 4))
        self._settings[..., 2] = -math.expm1(-dt / p.feedforward_memory)
        window = max(round(p.watch_time / dt), 1)
        self._watch_settings = np.array([window, p.watch_ratio, p.feedforward_floor])

    def apply(self, parameters: 'ControllerParameters') -> None:
        """Take new settings; those that shape the filter are read-only."""
        self.parameters = parameters
        self._tune()

    def _room(self, length: int) -> None:
        """Make room for a model of that length, at rest and without effect."""
        self._num = np.zeros((*self.shape, length))
        self._den = np.zeros((*self.shape, length))
        self._den[..., 0] = 1.0
        self._filters = np.zeros((*self.shape, 3, length))

    # ------------------------------------------------------------------------------------ model
    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:  # noqa: ARG002
        """Take the secondary path where it is trusted; the voltage does not jump, for u = w^T phi has no G_hat."""
        a = np.broadcast_to(model.a, (*self.shape, model.a.shape[-1]))
        b = np.broadcast_to(model.b, (*self.shape, model.b.shape[-1]))
        # the voltages of the line are one sample old, so one sample of the delay is behind them
        first = model.delay - 1
        length = max(1 + a.shape[-1], first + b.shape[-1], self._num.shape[-1])
        num, den = np.zeros((2, *self.shape, length))
        num[..., first : first + b.shape[-1]] = b
        den[..., 0] = 1.0
        den[..., 1 : 1 + a.shape[-1]] = a
        old = self._num.shape[-1]
        pad = [(0, 0)] * len(self.shape) + [(0, length - old)]
        old_num, old_den = np.pad(self._num, pad), np.pad(self._den, pad)
        pick = np.broadcast_to(trusted, self.shape)[..., None]
        num, den = np.where(pick, num, old_num), np.where(pick, den, old_den)
        fresh = np.any((num != old_num) | (den != old_den), axis=-1)
        self._known = self._known | trusted
        if not fresh.any():
            return
        filters = np.pad(self._filters, [(0, 0)] * (len(self.shape) + 1) + [(0, length - old)])
        self._num, self._den, self._filters = num, den, filters
        self._replay(fresh, reference_too=False)
        # another model is another chance
        reset = np.zeros(SIZE)
        reset[PACE] = 1.0
        given_up = fresh & (self._watch[..., COUNT] > 0.0)
        self._watch[...] = np.where(given_up[..., None], reset, self._watch)

    def _replay(self, where: Mask, reference_too: bool) -> None:
        """Run the stored history through the present model (and reaction) from rest."""
        lower, applied, own = np.moveaxis(np.roll(self._past, -self._next, axis=1), 1, -1)
        fresh = [
            np.zeros_like(s)
            for s in (self._voltages, self._before, self._filters, self._motion, self._lines)
        ]
        run_line(
            lower, applied, own, self.protection.reaction, self._num, self._den,
            self._coefficients, self._sizes, self.weights, *fresh,
        )  # fmt: skip
        voltages, before, filters, motion, lines = fresh
        if not reference_too:  # what u is made of stays as it is, to the last bit
            voltages, before[..., 0] = self._voltages, self._before[..., 0]
            motion[..., 0, :], lines[..., 0, :] = self._motion[..., 0, :], self._lines[..., 0, :]
        pick, pick2 = where[..., None], where[..., None, None]
        self._voltages[...] = np.where(pick, voltages, self._voltages)
        self._before[...] = np.where(pick, before, self._before)
        self._filters[...] = np.where(pick2, filters, self._filters)
        self._motion[...] = np.where(pick2, motion, self._motion)
        self._lines[...] = np.where(pick2, lines, self._lines)

    # ------------------------------------------------------------------------------------- step
    def step(self, x: LawInput, phase: Phase) -> Array:
        """Give the voltage (shape, V)."""
        acting = phase in {Phase.ADAPT, Phase.CONTROL}
        acted = self._phase in {Phase.ADAPT, Phase.CONTROL}
        measured, lower = self._measured(x)
        own = x.applied if acted else np.zeros(self.shape)
        if Phase.IDENTIFY in {phase, self._phase}:
            self.protection.learn(lower, x.applied, measured)
            if phase != Phase.IDENTIFY:
                self._replay_reaction()
        reference, effect = run_line(
            lower[..., None], x.applied[..., None], own[..., None],
            self.protection.reaction, self._num, self._den, self._coefficients, self._sizes,
            self.weights, self._voltages, self._before, self._filters, self._motion, self._lines,
        )  # fmt: skip
        reference, effect = reference[..., 0], effect[..., 0]
        self._past[:, self._next] = lower, x.applied, own
        self._next = (self._next + 1) % self._past.shape[1]

        complete = measured & (self._need <= 0.0)
        alone = phase != Phase.IDENTIFY and self._phase != Phase.IDENTIFY
        # cut by the limit, and not only held back by somebody else
        cut = x.saturated & acted & (np.abs(x.applied - self._demand * x.fade) > CUT)
        verdict, loud = watch(
            x.upper, reference, np.where(acted, effect, 0.0), cut, x.valid & complete & alone,
            acting, self._watch_settings, self._watch,
        )  # fmt: skip
        self._phase = phase
        able = complete & self._known & ((verdict == LEARN) | (verdict == LISTEN))
        active = able & loud & x.valid & ~x.saturated & acting
        predicted = x.upper - effect
        error = predicted + inner(self.weights, self._lines[..., 1, :])
        self._adapt(error, active, cut, verdict)
        wanted = self._watch[..., SHARE] * inner(self.weights, self._lines[..., 0, :])
        self._demand = np.where(complete & self._known & acting, wanted, 0.0)
        self._show(x, reference, predicted, active)
        why = np.where(loud, np.where(x.saturated & acted, SATURATED, 0), SMALL)
        for case, code in (
            (verdict == LISTEN, LISTENING), ((verdict == FADE) | (verdict == RESTART), BACKED_OFF),
            (self._need > 0.0, FILLING), (~measured, MISSING),
            (verdict == GIVEN_UP, GAVE_UP), (~self._known, NO_MODEL),
        ):  # fmt: skip
            why = np.where(case, code, why)
        self.state.reason = why
        return self._demand

    def _measured(self, x: LawInput) -> tuple[Mask, Array]:
        """Whether the lower sensor was measured, and its value or the last one that was; count what is missing."""
        measured = np.isfinite(x.lower)
        lower = np.where(measured, x.lower, self._last)
        self._last = lower
        self._missing = np.where(measured, 0.0, self._missing + 1.0)
        taps = self.parameters.feedforward_taps
        spoiled = taps + np.where(self._missing > SHORT_GAP, self._settle, 0.0)
        self._need = np.where(measured, self._need - 1.0, np.maximum(self._need, spoiled))
        return measured, lower

    def _replay_reaction(self) -> None:
        """IDENTIFY has ended: the reference gets its protection, as if it had had it all the time."""
        self.protection.finish()
        self._replay(np.ones(self.shape, dtype=bool), reference_too=True)

    def _adapt(self, error: Array, active: Mask, cut: Mask, verdict: Array) -> None:
        """Move the weights and keep them within their bounds."""
        p, filtered = self.parameters, self._lines[..., -1, :]
        pace, settings = self._watch[..., PACE], self._settings
        settings[..., 1] = np.minimum(p.feedforward_leak * self._boost, 1.0)
        if p.feedforward_method == 'fxlms':
            settings[..., 0] = pace * p.feedforward_step
            power = self._power[..., :1]
            norm = fxlms(filtered, error, active, settings, self.weights, power)
        else:
            settings[..., 0] = pace
            through = self._lines[..., 1, : self.weights.shape[-1] - self._poles]
            norm = fxrls(
                filtered, error, inner(through, through), active, settings,
                self.weights, self._U, self._d, self._power,
            )  # fmt: skip
        limit = p.feedforward_weight_limit
        scale = np.where(norm > limit * limit, limit / np.sqrt(np.maximum(norm, 1e-300)), 1.0)
        scale = np.where(cut, scale * (1.0 - min(self.dt / RAIL_TIME, 1.0)), scale)
        gone = (verdict == RESTART) | (verdict == GIVEN_UP)
        self.weights *= np.where(gone, 0.0, scale)[..., None]
        self._power[...] = np.where(gone[..., None], 0.0, self._power)
        if self._poles:
            stabilize(self.weights, self._poles, POLE_RADIUS)
        self._bound_loop()
        self.state.weight_norm = np.sqrt(inner(self.weights, self.weights))

    def _bound_loop(self) -> None:
        """Raise the leak while the loop through the other struts' reactions is too strong."""
        others = self.parameters.feedforward_struts - 1
        if others < 1 or self.protection.taps == 0:
            return
        gain = others * loop_gain(self.weights, self._table, self._poles, self.protection.magnitude)
        above = gain > LOOP_GAIN
        boost = np.where(above, self._boost * BOOST, self._boost / BOOST)
        most = 1.0 / self.parameters.feedforward_leak
        self._boost = np.minimum(np.maximum(boost, 1.0), most)
        # the leak needs time; twice the bound is not waited for
        hard = np.where(gain > 2.0 * LOOP_GAIN, 2.0 * LOOP_GAIN / np.maximum(gain, 1e-300), 1.0)
        self.weights *= hard[..., None]

    def _show(self, x: LawInput, reference: Array, predicted: Array, active: Mask) -> None:
        state = self.state
        state.reference, state.model_output, state.error = reference, predicted, x.upper
        state.adapting = active

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget weights and filters; the identified model and the learnt reaction stay."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)
        for array in (
            self.weights, self._lines, self._motion, self._before, self._voltages, self._filters,
            self._power, self._U, self._d, self._watch,
        ):  # fmt: skip
            wide = pick.reshape(pick.shape + (1,) * (array.ndim - pick.ndim))
            array[...] = np.where(wide, 0.0, array)
        self._past[...] = np.where(pick, 0.0, self._past)
        self._watch[..., PACE] = np.where(pick, 1.0, self._watch[..., PACE])
        full = float(self.parameters.feedforward_taps + self._settle)
        self._need = np.where(pick, full, self._need)
        self._last = np.where(pick, 0.0, self._last)
        self._demand = np.where(pick, 0.0, self._demand)
