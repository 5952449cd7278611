# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What law model_reference designs from an identified model: loop, bounds of the gains, reference model."""

import cmath
import math
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_ident.models.iir_model import IirModel

from satvib_control.core.trusted_model import lengthen, select
from satvib_control.laws.model_reference.parameters import ModelReferenceParameters
from satvib_control.laws.model_reference.reference_model import designed_model
from satvib_control.laws.model_reference.step import Fixed, Gain, Loop
from satvib_control.model_analysis.dominant_mode import damping_gain, dominant_pole, polarity
from satvib_control.model_analysis.gain_bounds import gain_bounds
from satvib_control.model_analysis.gain_projection import loop_grid, ray
from satvib_control.model_analysis.transfer import model_polynomials, multiply, value


class Design(NamedTuple):
    """What follows from the model, for each item.

    Attributes:
        loop: (*shape, Loop, q).
        fixed: (*shape, Fixed, q).
        sign: shape, polarity of the plant.
        wanted: shape, K_i of the reference model.
        low, high: shape, bounds of K_i.
        start: (*shape, Gain) gains to begin with, V/(m/s), V/m and V/(m/s^2), within the bounds.
        sizes: (*shape, Gain) size of each gain.
        grid: (*shape, 6, points) of `gain_projection`.
        attainable: shape, bool; the wanted damping is within the bounds.
        amplitude: shape, m/s^2; of the reference in ADAPT.
    """

    loop: Array
    fixed: Array
    sign: Array
    wanted: Array
    low: Array
    high: Array
    start: Array
    sizes: Array
    grid: Array
    attainable: Mask
    amplitude: Array

    @classmethod
    def without_model(cls, shape: tuple[int, ...], integrator: tuple[Array, Array]) -> 'Design':
        """A design without effect."""
        loop = np.zeros((*shape, len(Loop), 6))
        loop[..., Loop.OPEN, 0] = 1.0
        one = np.ones((*shape, 1))
        return cls(
            loop=loop,
            fixed=_fixed(0.0 * one, one, integrator, 6),
            sign=np.zeros(shape),
            wanted=np.zeros(shape),
            low=np.zeros(shape),
            high=np.zeros(shape),
            start=np.zeros((*shape, len(Gain))),
            sizes=np.zeros((*shape, len(Gain))),
            grid=np.zeros((*shape, 6, 1)),
            attainable=np.ones(shape, dtype=bool),
            amplitude=np.zeros(shape),
        )

    def within(self, gains: Array, p: ModelReferenceParameters) -> Array:
        """Project gains (*shape, Gain) on what the model proves stable with the modulus margin."""
        gains = gains.copy()
        gains[..., Gain.KI] = np.minimum(np.maximum(gains[..., Gain.KI], self.low), self.high)
        if several(p):
            gains = ray(gains, self.sizes, self.grid, p.modulus_margin)
        return gains

    def restarted(self, p: ModelReferenceParameters) -> 'Design':
        """Take the gains to begin with from other parameters; the model is the same."""
        design = self._replace(grid=_grid(self.loop, p))
        start = self.sign[..., None] * np.array([p.gain_p, p.gain_i, p.gain_d])
        return design._replace(start=design.within(start, p))

    def renewed(self, new: 'Design', trusted: Mask) -> 'Design':
        """Take a new design where it is trusted (shape)."""
        length = max(self.loop.shape[-1], new.loop.shape[-1])
        old = self._replace(loop=lengthen(self.loop, length), fixed=lengthen(self.fixed, length))
        new = new._replace(loop=lengthen(new.loop, length), fixed=lengthen(new.fixed, length))
        return Design._make(select(trusted, b, a) for a, b in zip(old, new, strict=True))


def several(p: ModelReferenceParameters) -> bool:
    """Whether several gains are projected together, which costs a pass over the Nyquist curve."""
    return bool(set(p.adapted_gains) - {'ki'}) or p.gain_p != 0.0 or p.gain_d != 0.0


def make_design(
    model: IirModel,
    p: ModelReferenceParameters,
    dt: float,
    integrator: tuple[Array, Array],
    covariance: Array | None,
) -> Design:
    """Design for every item of a model.

    Args:
        model: shape.
        p: of the law.
        dt: s.
        integrator: (3), (3) numerator and denominator of F.
        covariance: (*shape, n + m, n + m) of the model's parameters.
    """
    fb, fa = integrator
    loop = _loop(model, dt, integrator)
    confidence = p.gain_confidence
    bounds = gain_bounds(
        model, fb, fa, p.modulus_margin, covariance if confidence > 0.0 else None, confidence
    )
    sign, pole = polarity(model, fb, fa), dominant_pole(model, fb, fa)
    limit = np.where(sign > 0.0, bounds.maximum, bounds.minimum)
    wanted, damping = damping_gain(model, fb, fa, limit, p.reference_damping)
    speed = np.maximum(np.abs(pole), 1e-3)
    sizes = np.stack([np.abs(limit) / speed, np.abs(limit), np.abs(limit) / speed**2], axis=-1)
    b, a = model_polynomials(model)
    fixed = _fixed(b, a, integrator, loop.shape[-1])
    if p.reference_model == 'designed':
        designed = designed_model(
            model, 2.0 * math.pi * p.reference_frequency, p.reference_damping, pole
        )
        fixed[..., Fixed.DESIGNED_B : Fixed.DESIGNED_A + 1, : designed.shape[-1]] = designed
    grid = _grid(loop, p)
    start = sign[..., None] * np.array([p.gain_p, p.gain_i, p.gain_d])
    design = Design(
        loop=loop,
        fixed=fixed,
        sign=sign,
        wanted=wanted,
        low=np.minimum(limit, 0.0),
        high=np.maximum(limit, 0.0),
        start=start,
        sizes=sizes,
        grid=grid,
        attainable=damping >= p.reference_damping,
        amplitude=p.reference_voltage / _voltage_per_reference(wanted, loop, dt, integrator, p),
    )
    return design._replace(start=design.within(start, p))


def _grid(loop: Array, p: ModelReferenceParameters) -> Array:
    """Where several gains are projected together, the points of the Nyquist curve (*shape, 6, points)."""
    if not several(p):
        return np.zeros((*loop.shape[:-2], 6, 1))
    return loop_grid([loop[..., i, :] for i in (Loop.P, Loop.I, Loop.D)], loop[..., Loop.OPEN, :])


def _loop(model: IirModel, dt: float, integrator: tuple[Array, Array]) -> Array:
    """The polynomials of the loop (*shape, Loop, q)."""
    fb, fa = integrator
    b, a = model_polynomials(model)
    derivative = np.array([1.0, -1.0]) / dt
    rows = {
        Loop.OPEN: multiply(a, fa),
        Loop.P: multiply(b, fa),
        Loop.I: multiply(b, fb),
        Loop.D: multiply(multiply(b, fa), derivative),
    }
    loop = np.zeros((*b.shape[:-1], len(Loop), rows[Loop.D].shape[-1]))
    for place, row in rows.items():
        loop[..., place, : row.shape[-1]] = row
    return loop


def _fixed(b: Array, a: Array, integrator: tuple[Array, Array], length: int) -> Array:
    """The polynomials that do not depend on the gains (*shape, Fixed, length), the designed model without effect."""
    fixed = np.zeros((*b.shape[:-1], len(Fixed), length))
    fixed[..., Fixed.B, : b.shape[-1]], fixed[..., Fixed.A, : a.shape[-1]] = b, a
    fixed[..., Fixed.FB, :3], fixed[..., Fixed.FA, :3] = integrator
    fixed[..., Fixed.DESIGNED_A, 0] = 1.0
    return fixed


def _voltage_per_reference(
    gain: Array,
    loop: Array,
    dt: float,
    integrator: tuple[Array, Array],
    p: ModelReferenceParameters,
) -> Array:
    """|K F S| at the strongest of the reference's frequencies (shape), V per m/s^2, at least a trifle."""
    fb, fa = integrator
    closed = loop[..., Loop.OPEN, :] + gain[..., None] * loop[..., Loop.I, :]
    out = np.full(gain.shape, 1e-6)
    for i in np.ndindex(gain.shape):
        for frequency in p.reference_frequencies:
            zi = cmath.exp(-2j * math.pi * frequency * dt)
            s = value(loop[i][Loop.OPEN], zi) / value(closed[i], zi)
            out[i] = max(out[i], abs(float(gain[i]) * value(fb, zi) / value(fa, zi) * s))
    return out
