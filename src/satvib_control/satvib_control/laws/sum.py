# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The sum of laws, as in velocity_feedback+feedforward: one anti-windup and one gain budget.

    u = u_f + u_c,    u_f of the feedback laws, u_c of the laws that cancel (`cancels`: feedforward, narrowband).

With y = G u + d and u_f = -C y the feedback makes y = S (G u_c + d). A canceller on y would have to adapt through S G,
and that path changes with the gain of the feedback. So the feedback laws get y itself, and the cancellers get

    y_c = y - G_hat u_f = G u_c + d    (G_hat = G),

the vibration without the feedback. Their path is G for any feedback, and when they bring y_c to 0, y = S y_c is 0 too.
So the adaptation of one law does not change the plant of the other.

Anti-windup. What the guard cuts is cut from the cancellers, so the damping of the feedback stays. Every part gets its
own share, and the information that the voltage was saturated.

Gain budget. |S| of all parts together must stay below 1 / modulus_margin. The |S| of several loops multiply, so each of
n loops gets the n-th root of it. Feedforward closes no loop and needs none of it. Narrowband beside loops that are
fixed filters, as velocity_feedback is, knows |S_f| of theirs and keeps |S_f| |S| below the whole of it, frequency by
frequency. With the root alone its notches were so narrow beside a soft mode that a tone took a minute.
"""

import math
from dataclasses import replace

import numpy as np
from satvib_common.arrays import Array, Complex, Mask
from satvib_common.phases import Phase
from satvib_ident.models.iir_model import IirModel

from satvib_control.core.trusted_model import TrustedModel
from satvib_control.laws.base import STATE_FIELDS, BasicLaw, Law, LawInput
from satvib_control.laws.parameters import LawParameters


class LawSum(BasicLaw[LawParameters]):
    """Several laws on one coil; see the module.

    Args:
        laws: classes of the laws.
        parameters: of the controller.
        dt: s.
        shape: leading axes.
    """

    def __init__(
        self,
        laws: list[type[Law]],
        parameters: LawParameters,
        dt: float,
        shape: tuple[int, ...] = (),
    ) -> None:
        super().__init__(parameters, dt, shape)
        loops = sum(law.closes_loop for law in laws)
        self._budget = parameters.modulus_margin ** (1.0 / max(loops, 1))
        self._hearing = [self._hears(law, laws) for law in laws]
        self.parts: list[Law] = [
            law(self._shared(parameters, hears), dt, shape)
            for law, hears in zip(laws, self._hearing, strict=True)
        ]
        self.needs_model = any(law.needs_model for law in self.parts)
        self.closes_loop = loops > 0
        self.cancels = all(law.cancels for law in self.parts)
        self._demands = [np.zeros(shape) for _ in self.parts]
        self._model = TrustedModel(shape)

    @staticmethod
    def _hears(law: type[Law], laws: list[type[Law]]) -> bool:
        """Whether a law can keep the margin of all loops together: it hears its partners, and these are known."""
        partners = [other for other in laws if other is not law and other.closes_loop]
        return getattr(law, 'hears_partners', False) and all(
            getattr(other, 'fixed_filter', False) for other in partners
        )

    def _shared(self, parameters: LawParameters, hears: bool) -> LawParameters:
        return parameters if hears else parameters.changed({'modulus_margin': self._budget})

    def _response(self, omega: Array) -> Complex:
        """C of the loops that are fixed filters together."""
        total = np.zeros(omega.shape, dtype=complex)
        for law in self.parts:
            if isinstance(law, BasicLaw) and law.fixed_filter:
                total = total + law.response(omega)
        return total

    def set_model(self, model: IirModel, trusted: Mask, covariance: Array | None = None) -> None:
        """Give the model to every part, and keep it to separate the effects of the parts."""
        self._model.take(model, trusted)
        for law in self.parts:
            law.set_model(model, trusted, covariance)
        self._introduce()

    def _introduce(self) -> None:
        """Tell the laws that hear their partners what C of these is now."""
        for law, hears in zip(self.parts, self._hearing, strict=True):
            if hears and isinstance(law, BasicLaw):
                law.hear_partners(self._response)

    def _shares(self, x: LawInput) -> list[Array]:
        """Give each part's share of the last voltage: its faded demand, without what the guard cut."""
        shares = [demand * x.fade for demand in self._demands]
        total = np.zeros(self.shape)
        for share in shares:
            total = total + share
        order = [i for i, law in enumerate(self.parts) if law.cancels] or list(range(len(shares)))
        cut = (x.applied - total) / len(order)
        for i in order:
            shares[i] = shares[i] + cut
        return shares

    def step(self, x: LawInput, phase: Phase) -> Array:
        """Give the voltage (shape, V) of all parts together."""
        shares = self._shares(x)
        feedback = np.zeros(self.shape)
        for law, share in zip(self.parts, shares, strict=True):
            if not law.cancels:
                feedback = feedback + share
        without = np.where(x.valid, x.upper - self._model.effect(feedback), 0.0)
        total = np.zeros(self.shape)
        for i, law in enumerate(self.parts):
            upper = without if law.cancels else x.upper
            part = replace(x, upper=upper, applied=shares[i])
            self._demands[i] = law.step(part, phase)
            total = total + self._demands[i]
        self._show()
        return total

    def _show(self) -> None:
        """Merge the states of the parts: of each figure the first that is known, and the first reason."""
        state = self.state
        for name in STATE_FIELDS:
            merged = getattr(self.parts[-1].state, name)
            for law in reversed(self.parts[:-1]):
                own = getattr(law.state, name)
                if self.shape:
                    merged = np.where(np.isnan(own), merged, own)
                elif not math.isnan(own):  # one strut
                    merged = own
            setattr(state, name, merged)
        state.adapting = np.zeros(self.shape, dtype=bool)
        state.reason = np.zeros(self.shape, dtype=np.int64)
        for law in self.parts:
            state.adapting = state.adapting | law.state.adapting
            state.reason = np.where(state.reason == 0, law.state.reason, state.reason)

    def apply(self, parameters: LawParameters) -> None:
        """Give new settings to every part."""
        super().apply(parameters)
        for law, hears in zip(self.parts, self._hearing, strict=True):
            law.apply(self._shared(parameters, hears))
        if self._model.known.any():
            self._introduce()

    def effect_of(self, names: frozenset[str], known: bool) -> str:
        """Say what every part says."""
        parts = [law for law in self.parts if isinstance(law, BasicLaw)]
        return '; '.join(filter(None, (law.effect_of(names, known) for law in parts)))

    def reset(self, mask: Mask | bool = True) -> None:
        """Reset every part."""
        self._model.reset(mask)
        for i, law in enumerate(self.parts):
            law.reset(mask)
            self._demands[i] = np.where(mask, 0.0, self._demands[i])
