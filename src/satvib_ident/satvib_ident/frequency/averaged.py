# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Frequency responses from averaged spectra: H1, H2 and Hv of one input, H1 of several inputs.

    H1 = S_yx / S_xx                         noise at the output only
    H2 = S_yy / S_xy                         noise at the input only
    Hv = total least squares                 noise at both, in the ratio k of their powers:
    |Hv| = (a + sqrt(a^2 + 4 k |S_yx|^2)) / (2 |S_yx|),  a = S_yy - k S_xx,  with the phase of S_yx
    gamma^2 = |S_yx|^2 / (S_xx S_yy)         coherence

    several inputs: H1 = S_yx S_xx^-1,  gamma^2 = (H1 S_xy)_ii / S_yy,ii (multiple coherence)

The disc of confidence is that of `confidence` with the variance S_ee / (n P). P is the power of the input that the
response explains, and S_ee = S_yy + |H|^2 S_xx - 2 Re(H* S_yx) the power that it leaves unexplained. For H1 and one
input the relative radius is that of Bendat and Piersol, sqrt(((1 - c)^(-1 / (n - 1)) - 1) (1 - gamma^2) / gamma^2).

J. S. Bendat and A. G. Piersol, Random Data, 4th edition, 2010, chapters 6, 7 and 9; H. Vold, J. Crowley and G. T.
Rocklin, Sound and Vibration 18, 1984 (Hv).
"""

import numpy as np
from satvib_common.arrays import Array, Complex

from satvib_ident.frequency.confidence import disc_factor
from satvib_ident.frequency.response import FrequencyResponse
from satvib_ident.frequency.settings import FrfSettings
from satvib_ident.frequency.spectra import Spectra, averaged_spectra

# inputs whose normalized spectra have a smaller eigenvalue are not told apart
INDEPENDENT = 1e-3


def averaged_response(
    x: Array, y: Array, dt: float, settings: FrfSettings | None = None
) -> FrequencyResponse:
    """Estimate the response from one input to one output.

    Args:
        x: (..., t) input; NaN where a sample is missing.
        y: (..., t) output.
        dt: s.
        settings: see `FrfSettings`.

    Returns:
        Values (..., f).

    Raises:
        SatvibError: the record is too short.
    """
    s = settings or FrfSettings()
    found = averaged_spectra(np.stack(np.broadcast_arrays(x, y), axis=-2), dt, s)
    m = found.matrix
    sxx, syy, syx = m[..., 0, 0].real, m[..., 1, 1].real, m[..., 1, 0]
    with np.errstate(divide='ignore', invalid='ignore'):
        coherence = np.abs(syx) ** 2 / (sxx * syy)
        value, power = _one_input(sxx, syy, syx, s)
        left = np.maximum(syy + np.abs(value) ** 2 * sxx - 2.0 * (value.conj() * syx).real, 0.0)
        n = found.averages[..., None]
        radius = np.sqrt(disc_factor(n - 1.0, s.confidence) * left / ((n - 1.0) * power))
    return FrequencyResponse(
        found.frequency, value, coherence, radius, float(np.min(found.averages)), s.confidence,
        _name(s.estimator, s, found),
    )  # fmt: skip


def _one_input(sxx: Array, syy: Array, syx: Complex, s: FrfSettings) -> tuple[Complex, Array]:
    """Give the estimate and the power of the input that it explains, (..., f) each."""
    size = np.abs(syx)
    if s.estimator == 'H1':
        return syx / sxx, sxx
    if s.estimator == 'H2':
        return syy / syx.conj(), size**2 / syy
    k = s.noise_ratio
    a = syy - k * sxx
    magnitude = (a + np.sqrt(a * a + 4.0 * k * size**2)) / (2.0 * size)
    return magnitude * syx / size, size / magnitude


def averaged_responses(
    x: Array, y: Array, dt: float, settings: FrfSettings | None = None
) -> FrequencyResponse:
    """Estimate the responses from q inputs to p outputs together, by H1.

    Args:
        x: (..., q, t) inputs, different enough to be told apart.
        y: (..., p, t) outputs.
        dt: s.
        settings: the estimator of it is not used.

    Returns:
        Values (..., p, q, f); the coherence is the multiple one, the same for all inputs. NaN at frequencies where the
        inputs cannot be told apart.

    Raises:
        SatvibError: the record is too short.
    """
    s = settings or FrfSettings()
    q = x.shape[-2]
    found = averaged_spectra(np.concatenate([x, y], axis=-2), dt, s)
    sxx, syx = found.matrix[..., :q, :q], found.matrix[..., q:, :q]
    syy = np.diagonal(found.matrix[..., q:, q:], axis1=-2, axis2=-1).real
    own = np.diagonal(sxx, axis1=-2, axis2=-1).real
    with np.errstate(divide='ignore', invalid='ignore'):
        scale = 1.0 / np.sqrt(own)
        alike = sxx * scale[..., :, None] * scale[..., None, :]
    known = np.asarray(np.isfinite(alike).all(axis=(-2, -1)))
    alike = np.where(known[..., None, None], alike, np.eye(q))
    apart = np.asarray(known & (np.linalg.eigvalsh(alike)[..., 0] > INDEPENDENT))
    safe = np.where(apart[..., None, None], sxx, np.eye(q))
    inverse = np.where(apart[..., None, None], np.linalg.inv(safe), np.nan)
    value = syx @ inverse
    explained = np.einsum('...ij,...ij->...i', value, syx.conj()).real
    n = found.averages[..., None]
    left = np.maximum(syy - explained, 0.0)
    with np.errstate(divide='ignore', invalid='ignore'):
        variance = left / (n[..., None] - q)
        spread = np.diagonal(inverse, axis1=-2, axis2=-1).real
        factor = disc_factor(n - q, s.confidence)[..., None, None]
        radius = np.sqrt(factor * variance[..., :, None] * spread[..., None, :])
        coherence = np.broadcast_to((explained / syy)[..., None], value.shape)
    return FrequencyResponse(
        found.frequency, np.moveaxis(value, -3, -1), np.moveaxis(coherence, -3, -1),
        np.moveaxis(radius, -3, -1), float(np.min(found.averages)), s.confidence,
        _name('H1', s, found),
    )  # fmt: skip


def _name(estimator: str, s: FrfSettings, found: Spectra) -> str:
    """Say how a response was found."""
    spacing = float(found.frequency[0])
    return (
        f'{estimator}, {int(np.min(found.segments))} segments of {1.0 / spacing:.3g} s ({s.window}, overlap '
        f'{s.overlap:g})'
    )
