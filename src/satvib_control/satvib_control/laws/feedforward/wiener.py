# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What feedforward could have achieved: the causal Wiener optimum and the coherence bound.

For stationary x and d the residual of a filter w on the regressor of `regressor_kernel` is d + w^T phi_f. The best
weights solve the normal equations

    (R + rho I) w = -r,    R = <phi_f phi_f^T>,    r = <phi_f d>,

over a record; rho is the leak of the adaptive laws, 0 for the optimum itself. For taps alone R is Toeplitz and follows
from correlations or spectra (`wiener_from_spectra`). No filter of that length can do better on these data while it
runs. The optimum is found on one part of the record and judged on another, so chance cannot improve the result.

Without causality and without a limit on length the bound is the coherence of x and d at each frequency,

    S_ee / S_dd = 1 - |S_xd|^2 / (S_xx S_dd),

Elliott, Signal Processing for Active Control, 2001, sections 3.3 and 3.4. All this is for analysis: whole records, one
item at a time.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.levels import decibel, rms_with_mean

from satvib_control.laws.feedforward.regressor_kernel import (
    Contents,
    RegressorState,
    motion_coefficients,
    run_regressor,
)

if TYPE_CHECKING:
    from satvib_ident.models.iir_model import IirModel


@dataclass(frozen=True)
class WienerOptimum:
    """The best filter for a record.

    Attributes:
        weights: (p,) V/(m/s^2), in the order of the regressor: taps, velocity, displacement.
        attenuation: dB, RMS of the residual over RMS of d on the part that judges; negative is better.
        attenuation_fitted: dB, the same on the part that the weights were found on.
        voltage_rms: V.
        voltage_peak: V.
    """

    weights: Array
    attenuation: float
    attenuation_fitted: float
    voltage_rms: float
    voltage_peak: float


@dataclass(frozen=True)
class CoherenceBound:
    """What no linear filter of the reference, causal or not, can pass.

    Attributes:
        frequency: (f,) Hz.
        coherence: (f,) from 0 to 1.
        attenuation: (f,) dB, bound at each frequency.
        total: dB, bound of the RMS.
        blocks: averaged; coherence has a bias of about 1 / blocks, no bound below -10 log10(blocks) dB is reliable.
    """

    frequency: Array
    coherence: Array
    attenuation: Array
    total: float
    blocks: int


def uncontrolled(upper: ArrayLike, voltage: ArrayLike, model: 'IirModel') -> Array:
    """d_hat = y - G_hat u (t,): the upper acceleration of a record as it would have been at 0 V.

    Args:
        upper: (t,) m/s^2, without bias.
        voltage: (t,) V, as it was let out on each sample.
        model: G_hat, a single one.
    """
    return np.asarray(upper, dtype=float) - model.simulate(voltage)


def regressors(
    reference: ArrayLike, model: 'IirModel', taps: int, motion: bool, corner: float = 0.5
) -> tuple[Array, Array]:
    """Give phi and phi_f, (t, p) each, over a record.

    Args:
        reference: (t,) m/s^2.
        model: G_hat, a single one.
        taps, motion, corner: as the parameters feedforward_*; corner in Hz.

    Raises:
        SatvibError: a reference that is not finite, a model that is not single.
    """
    x = np.asarray(reference, dtype=float)
    if x.ndim != 1 or model.shape:
        raise SatvibError('wiener: one reference (t,) and one model are expected')
    if not np.isfinite(x).all():
        raise SatvibError(f'wiener: sample {int(np.argmin(np.isfinite(x)))} is not finite')
    contents = Contents(taps, int(motion), 0)
    length = max(1 + model.order, model.delay - 1 + model.b.shape[-1], 2)
    num, den = np.zeros((2, length))
    num[model.delay - 1 : model.delay - 1 + model.b.shape[-1]] = model.b
    den[: 1 + model.order] = model.denominator
    zero, no_weights = np.zeros(1), np.zeros(contents.size)
    state = RegressorState.zeros(contents, reaction=1, path=length, shape=())
    settings = (motion_coefficients(corner, model.dt), np.array(contents))
    phi, through = np.zeros((2, len(x), contents.size))
    for k, value in enumerate(x):
        sample = np.array([value])
        run_regressor(sample, zero, zero, zero, num, den, *settings, no_weights, *state)
        phi[k], through[k] = state.regressor, state.filtered
    return phi, through


def wiener_optimum(
    reference: ArrayLike,
    disturbance: ArrayLike,
    model: 'IirModel',
    taps: int = 16,
    motion: bool = True,
    corner: float = 0.5,
    leak: float = 0.0,
    fitted: float = 0.5,
) -> WienerOptimum:
    """Find the best weights for a long record.

    Args:
        reference: (t,) m/s^2, without bias.
        disturbance: (t,) m/s^2, d: the upper acceleration at 0 V, or `uncontrolled`.
        model: G_hat, a single one.
        taps, motion, corner, leak: as the parameters feedforward_*; corner in Hz.
        fitted: share of the record that the weights are found on; the rest judges.

    Raises:
        SatvibError: a record that is too short, or not finite.
    """
    d = np.asarray(disturbance, dtype=float)
    phi, through = regressors(reference, model, taps, motion, corner)
    settle = 2 * taps
    split = settle + round(fitted * (len(d) - settle))
    if len(d) != len(phi) or split - settle < 10 * phi.shape[1] or len(d) - split < phi.shape[1]:
        raise SatvibError(f'wiener: {len(d)} samples are too few for {phi.shape[1]} weights')
    if not np.isfinite(d).all():
        raise SatvibError(f'wiener: sample {int(np.argmin(np.isfinite(d)))} is not finite')
    fit, judge = slice(settle, split), slice(split, len(d))
    rows, aim = through[fit], d[fit]
    size = rows.shape[1]
    rho = leak * float((rows * rows).sum()) / size
    # by rows, not by normal equations: the displacement and the taps are nearly dependent
    rows = np.vstack([rows, math.sqrt(rho) * np.eye(size)])
    weights = np.linalg.lstsq(rows, -np.concatenate([aim, np.zeros(size)]), rcond=None)[0]
    voltage = phi[judge] @ weights
    found = [_decibel(d[part] + through[part] @ weights, d[part]) for part in (judge, fit)]
    return WienerOptimum(
        weights, found[0], found[1], float(rms_with_mean(voltage)), float(np.abs(voltage).max())
    )


def wiener_from_spectra(
    reference: ArrayLike,
    cross: ArrayLike,
    disturbance: ArrayLike,
    response: ArrayLike,
    taps: int,
    leak: float = 0.0,
) -> tuple[Array, float]:
    """Best taps from spectra, by the correlations that they are transforms of.

    Args:
        reference: (f,) two-sided S_xx at f uniform frequencies over the whole circle from 0, as in `numpy.fft.fft`.
        cross: (f,) S_xd = <X* D>, complex.
        disturbance: (f,) S_dd.
        response: (f,) G_hat at these frequencies, complex.
        taps: length of the filter.
        leak: share of the mean power of the filtered reference.

    Returns:
        (taps,) weights in V/(m/s^2), and the attenuation in dB.
    """
    from scipy.linalg import solve_toeplitz

    sxx, sxd = np.asarray(reference, dtype=float), np.asarray(cross)
    sdd, g = np.asarray(disturbance, dtype=float), np.asarray(response)
    if not len(sxx) == len(sxd) == len(sdd) == len(g) or len(sxx) < 2 * taps:
        raise SatvibError(f'wiener: spectra of one length, at least {2 * taps}, are expected')
    own = np.fft.ifft(np.abs(g) ** 2 * sxx).real[:taps]
    # <x_f(k - i) d(k)>
    both = np.fft.ifft(np.conj(g) * sxd).real[:taps]
    first = own.copy()
    first[0] *= 1.0 + leak
    weights = -solve_toeplitz(first, both)
    z = np.exp(-2j * np.pi * np.outer(np.arange(len(sxx)) / len(sxx), np.arange(taps)))
    w = z @ weights
    left = sdd + 2.0 * (w * g * np.conj(sxd)).real + np.abs(w * g) ** 2 * sxx
    return weights, 10.0 * math.log10(max(float(left.sum() / sdd.sum()), 1e-300))


def coherence_bound(
    reference: ArrayLike, disturbance: ArrayLike, rate: float, block: int = 1024
) -> CoherenceBound:
    """Estimate the bound from a record (Welch, Hann window, half overlap).

    Args:
        reference: (t,) m/s^2.
        disturbance: (t,) m/s^2.
        rate: Hz.
        block: samples of a block; a mode of damping z at f needs several times rate / (z f).

    Raises:
        SatvibError: a record of less than four blocks.
    """
    from scipy.signal import csd, welch

    x, d = np.asarray(reference, dtype=float), np.asarray(disturbance, dtype=float)
    blocks = 2 * len(x) // block - 1
    if len(x) != len(d) or blocks < 7:
        raise SatvibError(f'coherence: {len(x)} samples are less than four blocks of {block}')
    frequency, sxx = welch(x, rate, nperseg=block)
    sdd = welch(d, rate, nperseg=block)[1]
    sxd = csd(x, d, rate, nperseg=block)[1]
    coherence = np.abs(sxd) ** 2 / np.maximum(sxx * sdd, 1e-300)
    left = np.maximum(1.0 - coherence, 1e-12)
    total = 10.0 * math.log10(float((left * sdd).sum() / sdd.sum()))
    return CoherenceBound(frequency, coherence, 10.0 * np.log10(left), total, blocks)


def _decibel(after: Array, before: Array) -> float:
    levels = [max(float(rms_with_mean(x)), 1e-300) for x in (after, before)]
    return float(decibel(*levels))
