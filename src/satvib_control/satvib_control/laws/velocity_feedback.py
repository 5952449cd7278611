# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Active velocity feedback: the paper's 1-DOF law (Fig. 7), a skyhook damper.

    u(k) = -g s v(k),    v = H y,    H(s) = s / (s + w_l)^2

y is the upper acceleration without bias. H is the drift-free integrator of `satvib_common.signals.integrator`; a pure
integrator would turn a bias into a ramp, the drift that the paper reports. s = +-1 is the polarity of the wiring, taken
from the identified model when there is one. g is the gain in V/(m/s).

The paper's "differential controller gain is 550" has no unit. Its figures are in g, so it is read as 550 V per (g s),
which is 550 / 9.80665 = 56.1 V/(m/s): the default.

The gain can be set while the law acts. The integrator goes on, so the next voltage differs by the ratio of the gains.

With an identified model, g is reduced to the bound that keeps the modulus margin, and the state says so; without, it is
`velocity_fallback_gain` at most.
"""

from typing import TYPE_CHECKING

import numpy as np
from satvib_common.arrays import Array, Complex, Mask
from satvib_common.phases import Phase
from satvib_common.signals.integrator import LeakyIntegrator

from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.parameters import VelocityParameters
from satvib_control.laws.reasons import reason, shown, text_of
from satvib_control.model_analysis.dominant_mode import polarity
from satvib_control.model_analysis.gain_bounds import gain_bounds

if TYPE_CHECKING:
    from satvib_ident.models.iir_model import IirModel

REDUCED = reason('the gain is reduced to the bound of the identified model')
UNPROVEN = reason('no identified model: the fallback gain and the polarity as set, not proven')


class VelocityFeedback(BasicLaw[VelocityParameters]):
    """u = -g s H y; see the module's page."""

    fixed_filter = True
    settings = VelocityParameters.own()

    def __init__(
        self, parameters: VelocityParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        self._integrator = LeakyIntegrator(parameters.velocity_corner, dt, shape)
        self._sign = np.zeros(shape)  # of the identified model; 0: there is none
        self._retune()

    def apply(self, parameters: VelocityParameters) -> None:
        """Take another gain, within the bounds of the identified model."""
        super().apply(parameters)
        self._retune()

    def _retune(self) -> None:
        p, state = self.parameters, self.state
        unproven = min(p.velocity_gain, p.velocity_fallback_gain) * p.velocity_polarity
        wanted = p.velocity_gain * self._sign
        known = self._sign != 0.0
        gain = np.minimum(np.maximum(wanted, state.ki_min), state.ki_max)
        self._gain = np.where(known, gain, unproven)
        state.ki = self._gain
        state.reason = np.where(known, np.where(gain != wanted, REDUCED, 0), UNPROVEN)

    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:
        """Take sign and bounds from the model where it is trusted."""
        p = self.parameters
        bounds = gain_bounds(
            model,
            self._integrator.b,
            self._integrator.a,
            p.modulus_margin,
            covariance if p.gain_confidence > 0.0 else None,
            p.gain_confidence,
        )
        sign = polarity(model, self._integrator.b, self._integrator.a)
        state = self.state
        self._sign = np.where(trusted, sign, self._sign)
        state.ki_min = np.where(trusted, bounds.minimum, state.ki_min)
        state.ki_max = np.where(trusted, bounds.maximum, state.ki_max)
        self._retune()

    def effect_of(self, names: frozenset[str], known: bool) -> str:  # noqa: ARG002 - it acts without a model, too
        """Say where the gain is not the one that was set."""
        wanted = self.parameters.velocity_gain
        if not names & self.settings or np.all(np.abs(self._gain) == wanted):
            return ''
        why = text_of(int(np.max(self.state.reason)))
        return f'{why}: {shown(self._gain)} V/(m/s) in use'

    def step(self, x: LawInput, phase: Phase) -> Array:  # noqa: ARG002 - the same in every phase
        """Give the voltage (shape, V)."""
        return -self._gain * self._integrator.velocity(x.upper)

    def response(self, omega: Array) -> Complex:
        """C = g s H at frequencies (*shape, q) in rad/sample."""
        turn = np.exp(-1j * omega)
        h = np.polyval(self._integrator.b[::-1], turn) / np.polyval(self._integrator.a[::-1], turn)
        return np.asarray(self._gain[..., np.newaxis] * h)

    def reset(self, mask: Mask | bool = True) -> None:
        """Empty the integrator; the gain stays."""
        self._integrator.reset(mask)
