# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Narrowband: unknown, changing tones rejected by feedback alone, on the identified model.

The law is internal-model control (Youla-Kucera, with the identified stable G as its own observer). What the strut would
do without control is

    d = y - G u_applied.

A stable Q gives a stable loop, u = -Q d, y = (1 - G Q) d, however fast Q changes, as long as the model is right. A
voltage that was limited or faded in does no harm. Q is a set of resonators on the tones that `search` finds in d and
`tracker` follows. With x_i the tone i as a rotating complex number and w_i its frequency,

    u = -sum Re(x_i / G(e^{j w_i})).

At w_i the sensitivity is 0 for a wrong model too: there d = p - (rho - 1) x with rho = G_true / G, so the tracker
sees x' = (p - rho x) / n. That is stable for phase errors below 90 degrees, and with the frequency loop around it
below some 67. Beyond them the first attempt fails, and the model is corrected by what it has shown.

Guarantees:

- max |S| on the model stays below 1 / modulus_margin (`margin`).
- The amplitudes of the voltage together stay below voltage_limit, small demands met first, so the guard does not cut.
- A voltage that does harm, or for long no good, is taken back (`backoff`). An attempt that made the vibration larger
  has shown how the plant answers at the tone, and the model is corrected there (`model_correction`).
- Where no tone stands out of the noise the voltage is 0.

The samples are what the law brings to zero. Where the images of the hold cost more than they are worth, a weight on
each tone's voltage serves the payload between the samples (`narrowband_serve`).

One sample (`step`): the observer gives d. The tracker follows its tones, and from time to time the search looks for
new ones. The tones ask for a voltage within the limit (`voltage`). The back-off lets it through or not, and the tones
are faded in.

A new model is run over the last seconds of the strut's past, so the tones are known before the first sample of CONTROL.
In ADAPT the law listens at 0 V.

References: Landau, Constantinescu, Rey, "Adaptive narrow band disturbance rejection applied to an active
suspension", Automatica 41 (2005) 563; Bodson, Douglas, "Adaptive algorithms for the rejection of sinusoidal
disturbances with unknown frequency", Automatica 33 (1997) 2213. What else was tried, and the numbers:
docs/narrowband.md.
"""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from satvib_common.arrays import Array, Complex, Mask
from satvib_common.phases import Phase

from satvib_control.core.trusted_model import TrustedModel, select
from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.narrowband.margin import margin_grid
from satvib_control.laws.narrowband.memory import (
    UNCORRECTED,
    Backoff,
    Correction,
    Design,
    Memory,
    Past,
    Point,
    Setting,
    Shown,
    Tone,
    Weight,
)
from satvib_control.laws.narrowband.parameters import NarrowbandParameters
from satvib_control.laws.narrowband.search import grid_size
from satvib_control.laws.narrowband.step import narrowband_replay, narrowband_step
from satvib_control.laws.reasons import last_of, reason

if TYPE_CHECKING:
    from satvib_ident.models.iir_model import IirModel

NO_MODEL = reason('no trusted identified model: 0 V')
NOTHING = reason('no tone stands out of the noise: 0 V')
HELD = reason('a tone is left alone: its voltage did not calm it, so the model is wrong there')
CORRECTED = reason('the model is corrected at the tone by what an attempt that failed has shown')
LIMITED = reason('the voltage limit does not cancel all of the tones')
SLOWED = reason('slowed down to keep the modulus margin')
PAST = 4.0  # s of the past that a new model is run over
FIRST_HOLD = 10.0  # paces


class Narrowband(BasicLaw[NarrowbandParameters]):
    """Resonators on tracked tones; see the module's page."""

    needs_model = True
    settings = NarrowbandParameters.own()
    cancels = True
    hears_partners = True

    def __init__(
        self, parameters: NarrowbandParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        self._no_reason = np.zeros(shape, dtype=np.int64)
        self._settings = _settings(parameters, dt)
        self._weights = _weights(parameters, dt)
        self._past = np.full((*shape, max(round(PAST / dt), 1), len(Past)), -1.0)
        self._next = 0
        self._model = TrustedModel(shape)
        self._points = np.zeros((*shape, 1, len(Point)))
        self._memory = self._at_rest()
        self._shown = np.zeros((*shape, len(Shown)))
        self.state.reason = np.full(shape, NO_MODEL)

    def _at_rest(self) -> Memory:
        s = self._settings
        window = int(s[Setting.WINDOW])
        frequencies = grid_size(s[Setting.LOW], s[Setting.HIGH], window)
        tones = self.parameters.narrowband_tones
        return Memory.at_rest(self.shape, self._model.state, tones, window, frequencies)

    def apply(self, parameters: NarrowbandParameters) -> None:
        """Take new settings; tones and spectra go on, so a voltage changes no faster than its tone is corrected."""
        super().apply(parameters)
        self._settings[:] = _settings(parameters, self.dt)

    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:  # noqa: ARG002 - the interface
        """Take the model where it is trusted and run it over the past, so that the tones are known at once."""
        given = self._model
        new = given.news(model, trusted)
        if not new.any():
            return
        # the tones are known where there was a model before
        follow = np.where(new, np.where(given.known, 0.0, 1.0), -1.0)
        given.take(model, new)
        given.reset(new)
        self._points = margin_grid(given.b, given.a)
        memory = self._memory = self._memory._replace(model=given.state)
        memory.backoff[..., Backoff.SLOW] = select(new, 1.0, memory.backoff[..., Backoff.SLOW])
        memory.correction[...] = select(new, UNCORRECTED, memory.correction)
        oldest = float(self._next)
        narrowband_replay(*self._design(), *memory, self._past, oldest, follow, self._shown)

    def hear_partners(self, response: Callable[[Array], Complex]) -> None:
        """Take C of the loops beside this one (`laws.sum`): |S| counts times theirs, where that is above 1."""
        points = self._points
        model = points[..., Point.RE] + 1j * points[..., Point.IM]
        with np.errstate(all='ignore'):
            partners = 1.0 / np.abs(1.0 + model * response(points[..., Point.OMEGA]))
        points[..., Point.PARTNERS] = np.fmax(partners, 1.0)

    def _design(self) -> Design:
        return Design(self._model.b, self._model.a, self._settings, self._points, self._weights)

    def step(self, x: LawInput, phase: Phase) -> Array:
        """Give the voltage (shape, V); 0 V in ADAPT, where the law only listens."""
        row = self._past[..., self._next, :]
        row[..., Past.UPPER] = x.upper
        row[..., Past.APPLIED] = x.applied
        measured = x.valid & ~x.upper_clipped
        row[..., Past.VALID] = measured
        self._next = (self._next + 1) % self._past.shape[-2]
        valid = np.where(self._model.known, np.where(measured, 1.0, 0.0), -1.0)
        act = np.where((phase == Phase.CONTROL) & self._model.known, 1.0, 0.0)
        u = narrowband_step(
            *self._design(), *self._memory, x.upper, x.applied, valid, act, self._shown
        )
        self._show()
        return np.asarray(u)

    def _show(self) -> None:
        shown, state, known = self._shown, self.state, self._model.known
        state.error = shown[..., Shown.ERROR].copy()
        state.frequency = shown[..., Shown.OMEGA] / (2.0 * math.pi * self.dt)
        state.weight_norm = shown[..., Shown.VOLTS].copy()
        state.sensitivity = shown[..., Shown.SENSITIVITY].copy()
        tracking = shown[..., Shown.TRACKING] > 0.0
        state.adapting = tracking & known
        corrected = self._memory.correction[..., Correction.CORRECTED_AT] > 0.0
        state.reason = last_of(
            self._no_reason,
            (shown[..., Shown.SLOWED] > 0.0, SLOWED),
            (corrected, CORRECTED),
            (shown[..., Shown.LIMITED] > 0.0, LIMITED),
            (shown[..., Shown.HELD] > 0.0, HELD),
            (~tracking, NOTHING),
            (~known, NO_MODEL),
        )

    def tones(self) -> tuple[Array, Array]:
        """Give frequency (Hz) and amplitude (m/s^2) of the tracked tones, (*shape, tones); NaN where there is none."""
        t = self._memory.tones
        on = t[..., Tone.ON] > 0.0
        amplitude = np.sqrt(t[..., Tone.RE] ** 2 + t[..., Tone.IM] ** 2)
        frequency = t[..., Tone.OMEGA] / (2.0 * math.pi * self.dt)
        return np.where(on, frequency, np.nan), np.where(on, amplitude, np.nan)

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget the tones and the noise where `mask` (shape) holds; model and past stay."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)
        for kept, start in zip(self._memory, self._at_rest(), strict=True):
            kept[...] = select(pick, start, kept)


def _settings(p: NarrowbandParameters, dt: float) -> Array:
    """Give the settings (Setting) in samples and rad/sample."""
    turn = 2.0 * math.pi * dt
    low, high = p.narrowband_low * turn, (p.narrowband_high or 0.45 / dt) * turn
    window = max(round(p.narrowband_window / dt), 12)
    edge = 0.5 * math.pi / window
    settings = np.zeros(len(Setting))
    settings[Setting.PACE] = p.narrowband_settling / dt
    settings[Setting.LONGEST] = p.narrowband_memory / dt
    # two points of the grid beyond the band, so that a tone at its edge is a local maximum
    settings[Setting.LOW] = max(low - 2.0 * math.pi / window, edge)
    settings[Setting.HIGH] = min(high + 2.0 * math.pi / window, math.pi - edge)
    settings[Setting.LEAST], settings[Setting.MOST] = low, high
    settings[Setting.SMALLEST] = p.narrowband_smallest
    settings[Setting.VOLTAGE] = p.voltage_limit
    settings[Setting.SENSITIVITY] = 1.0 / p.modulus_margin
    settings[Setting.FIRST_HOLD] = FIRST_HOLD * settings[Setting.PACE]
    settings[Setting.WINDOW] = window
    return settings


def _weights(p: NarrowbandParameters, dt: float) -> Array:
    """Give the weights (w, Weight); one row of 1 where the samples are served."""
    if p.narrowband_serve != 'payload':
        return np.array([[0.0, 1.0, 0.0]])
    weights = np.array(p.narrowband_weights, dtype=float).reshape(-1, len(Weight))
    weights[:, Weight.OMEGA] *= 2.0 * math.pi * dt
    return weights
