# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Narrowband: unknown, changing tones rejected by feedback alone, on the identified model.

Internal-model control (Youla-Kucera, with the identified stable G as its own observer). What the strut would feel
without control is

    d = y - G u_applied,

so a stable Q gives a stable loop, u = -Q d, y = (1 - G Q) d, however fast Q changes as long as the model is right,
and a voltage that was limited or faded in does no harm. Q is a set of resonators on the tones that `tone_search`
finds in d and `tone_tracker` follows. With x_i the tone i as a rotating complex number and w_i its frequency,

    u = -sum Re(x_i / G(e^{j w_i})).

At w_i the sensitivity is 0 for a wrong model too: there d = p - (rho - 1) x with rho = G_true / G, so the tracker
sees x' = (p - rho x) / n, which is stable for phase errors below 90 degrees and, with the frequency loop around it,
below some 67; beyond them the first attempt fails, and teaches.

Guarantees. max |S| on the model stays below 1 / modulus_margin (`tone_margin`). The amplitudes of the voltage
together stay below voltage_limit, small demands met first, so the guard does not clip. A voltage that does harm, or
for long no good, is taken back (`tone_watch`); what made it louder has shown how the plant answers at the tone, and
the model is corrected there (`tone_response`). Where no tone stands out of the noise the voltage is 0.

A model is run over the last seconds of the strut's past when it is handed over, so the tones are known before the
first sample of CONTROL. In ADAPT the law listens at 0 V.

References: Landau, Constantinescu, Rey, "Adaptive narrow band disturbance rejection applied to an active
suspension", Automatica 41 (2005) 563; Bodson, Douglas, "Adaptive algorithms for the rejection of sinusoidal
disturbances with unknown frequency", Automatica 33 (1997) 2213. What else was tried, and the numbers:
docs/narrowband.md.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.phases import Phase

from satvib_control.core.trusted_model import TrustedModel, select
from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.narrowband import step as nk
from satvib_control.laws.narrowband import tracker as tt
from satvib_control.laws.narrowband.margin import margin_grid
from satvib_control.laws.narrowband.model_correction import FIXED_AT, UNTAUGHT
from satvib_control.laws.narrowband.parameters import NarrowbandParameters
from satvib_control.laws.narrowband.search import grid_size
from satvib_control.laws.reasons import reason

if TYPE_CHECKING:
    from satvib_ident.models.iir_model import IirModel

NO_MODEL = reason('no trusted identified model: 0 V')
NOTHING = reason('no tone stands out of the noise: 0 V')
HELD = reason('a tone is left alone: its voltage did not calm it, so the model is wrong there')
CORRECTED = reason('the model is corrected at the tone by what an attempt that failed has shown')
LIMITED = reason('the voltage limit does not cancel all of the tones')
SLOWED = reason('slowed down to keep the modulus margin')
PAST = 4.0  # s of the past that a new model is run over


class Narrowband(BasicLaw[NarrowbandParameters]):
    """Resonators on tracked tones; see the module's page."""

    needs_model = True
    cancels = True

    def __init__(
        self, parameters: NarrowbandParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        p = parameters
        turn = 2.0 * math.pi * dt
        low, high = p.narrowband_low * turn, (p.narrowband_high or 0.45 / dt) * turn
        window = max(round(p.narrowband_window / dt), 12)
        settings = np.zeros(tt.SETTINGS)
        settings[tt.WANTED] = p.narrowband_settling / dt
        settings[tt.LONGEST] = p.narrowband_memory / dt
        # two points of the grid beyond the band, so that a tone at its edge is a local maximum
        low = max(low - 2.0 * math.pi / window, 0.5 * math.pi / window)
        high = min(high + 2.0 * math.pi / window, math.pi - 0.5 * math.pi / window)
        settings[tt.LOW], settings[tt.HIGH] = low, high
        settings[tt.SMALLEST] = p.narrowband_smallest
        settings[tt.PEAK] = 1.0 / p.modulus_margin
        settings[tt.FIRST_HOLD] = 10.0 * settings[tt.WANTED]
        settings[tt.WINDOW] = window
        self._settings = settings
        self.apply(p)
        self._past = np.full((*shape, max(round(PAST / dt), 1), 3), -1.0)
        self._next = 0
        self._model = TrustedModel(shape)
        self._points = np.zeros((*shape, 1, 3))
        self._tones = np.zeros((*shape, p.narrowband_tones, tt.TONE))
        self._common = np.zeros((*shape, tt.COMMON))
        self._rings = np.zeros((*shape, 2, window))
        self._floor = np.zeros((*shape, 3, grid_size(low, high, window)))
        self._lesson = np.tile(UNTAUGHT, (*shape, 1))
        self._show = np.zeros((*shape, nk.SHOW))
        self.reset()
        self.state.reason = np.full(shape, NO_MODEL)

    def apply(self, parameters: NarrowbandParameters) -> None:
        """Take a new voltage limit."""
        super().apply(parameters)
        self._settings[tt.VOLTAGE] = parameters.voltage_limit

    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:  # noqa: ARG002 - the interface
        """Take the model where it is trusted and run it over the past, so that the tones are known at once."""
        given = self._model
        new = given.news(model, trusted)
        if not new.any():
            return
        follow = np.where(new, np.where(given.known, 0.0, 1.0), -1.0)
        given.take(model, new)
        given.reset(new)
        self._points = margin_grid(given.b, given.a)
        self._common[..., tt.SLOW] = select(new, 1.0, self._common[..., tt.SLOW])
        self._lesson = select(new, UNTAUGHT, self._lesson)
        nk.narrowband_replay(
            given.b, given.a, self._settings, self._points, given.state, self._common,
            self._tones, self._rings, self._floor, self._lesson, self._past, float(self._next), follow, self._show,
        )  # fmt: skip

    def step(self, x: LawInput, phase: Phase) -> Array:
        """Give the voltage (shape, V); 0 V in ADAPT, where the tones are only listened to."""
        row = self._past[..., self._next, :]
        row[..., 0], row[..., 1], row[..., 2] = x.upper, x.applied, x.valid
        self._next = (self._next + 1) % self._past.shape[-2]
        act = (phase == Phase.CONTROL) & self._model.known
        u = nk.narrowband_step(
            self._model.b, self._model.a, self._settings, self._points, self._model.state, self._common,
            self._tones, self._rings, self._floor, self._lesson, x.upper, x.applied,
            np.where(self._model.known, np.where(x.valid, 1.0, 0.0), -1.0), np.where(act, 1.0, 0.0), self._show,
        )  # fmt: skip
        self._tell()
        return np.asarray(u)

    def _tell(self) -> None:
        show, state = self._show, self.state
        turn = 2.0 * math.pi * self.dt
        state.error = show[..., nk.SHOW_ERROR].copy()
        state.frequency = show[..., nk.SHOW_OMEGA] / turn
        state.weight_norm = show[..., nk.SHOW_VOLTS].copy()
        state.sensitivity = show[..., nk.SHOW_PEAK].copy()
        state.adapting = (show[..., nk.SHOW_MOVING] > 0.0) & self._model.known
        why = np.where(show[..., nk.SHOW_SLOW] > 0.0, SLOWED, 0)
        why = np.where(self._lesson[..., FIXED_AT] > 0.0, CORRECTED, why)
        why = np.where(show[..., nk.SHOW_LIMITED] > 0.0, LIMITED, why)
        why = np.where(show[..., nk.SHOW_HELD] > 0.0, HELD, why)
        why = np.where(show[..., nk.SHOW_MOVING] > 0.0, why, NOTHING)
        state.reason = np.where(self._model.known, why, NO_MODEL)

    def tones(self) -> tuple[Array, Array]:
        """Give frequency (Hz) and amplitude (m/s^2) of the tracked tones, (*shape, tones); NaN where there is none."""
        t = self._tones
        on = t[..., tt.ON] > 0.0
        amplitude = np.sqrt(t[..., tt.RE] ** 2 + t[..., tt.IM] ** 2)
        frequency = t[..., tt.OMEGA] / (2.0 * math.pi * self.dt)
        return np.where(on, frequency, np.nan), np.where(on, amplitude, np.nan)

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget the tones and the noise; model and past stay."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)[..., None]
        self._common[...] = np.where(pick, 0.0, self._common)
        self._lesson[...] = np.where(pick, UNTAUGHT, self._lesson)
        for memory in (self._tones, self._rings, self._floor):
            memory[...] = np.where(pick[..., None], 0.0, memory)
        for place in (tt.STRETCH, tt.SLOW):
            now = self._common[..., place]
            self._common[..., place] = np.where(pick[..., 0], 1.0, now)
