# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a model may be believed, and why not.

The checks, in the order in which they are named:

1. enough samples have been used (at least `trust_samples` per parameter);
2. the estimate is finite;
3. the model is stable (pole modulus below `trust_pole_modulus`), because the struts are;
4. the input was persistently exciting of the order n + m, at the last sample that was used;
5. the information matrix is regular (condition below `trust_condition`);
6. the frequency response is known in `trust_band` (relative deviation below `trust_deviation`);
7. what the residual has in common with the input says that the response is right in that band (relative error below
   `trust_error`), and the input has power enough there to say so;
8. the residual is white (Q / h below `trust_whiteness`), if asked for.
"""

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.kernels.compile import kernel

from satvib_ident.parameters import IdentifierParameters


@kernel('void(b1, b1, f8, f8, f8, f8, f8, f8, f8[:], i8[:])', '(),(),(),(),(),(),(),(),(l)->()')
def _failed(few, finite, modulus, order, condition, deviation, error, colour, limits, out):
    """Number of the first check that fails, 0 if none.

    What is not known (NaN: an estimator without covariance, a window not filled) fails none but the one on poles.
    """
    if few:
        out[0] = 1
    elif not finite:
        out[0] = 2
    elif not modulus < limits[0]:
        out[0] = 3
    elif order < limits[1]:
        out[0] = 4
    elif condition >= limits[2]:
        out[0] = 5
    elif deviation >= limits[3]:
        out[0] = 6
    elif error >= limits[4]:
        out[0] = 7
    elif colour > limits[5]:
        out[0] = 8
    else:
        out[0] = 0


@dataclass(frozen=True, eq=False)
class Verdict:
    """What was measured, arrays of one shape, and which check failed first (0: none)."""

    parameters: IdentifierParameters
    updates: Array
    finite: Mask
    pole_modulus: Array
    excitation_order: Array
    information_eigenvalue: Array
    information_condition: Array
    response_deviation: Array
    model_error: Array
    whiteness: Array
    failed: Integers

    @property
    def converged(self) -> Mask:
        """The model may be believed, (shape)."""
        return self.failed == 0

    def renewed(self, fresh: 'Verdict', mask: Mask) -> 'Verdict':
        """Give the items of `fresh` where `mask` (shape) holds, and of this verdict elsewhere."""
        if mask.all():
            return fresh
        names = (f.name for f in fields(self) if f.name != 'parameters')
        merged = {n: np.where(mask, getattr(fresh, n), getattr(self, n)) for n in names}
        return replace(fresh, **merged)

    def reason(self, index: tuple[int, ...] = ()) -> str:
        """Why the model of one item may not be believed; '' when it may."""
        p = self.parameters
        match int(self.failed[index]):
            case 1:
                return f'{self.updates[index]:.0f} samples used of {p.trust_samples * p.count}'
            case 2:
                return 'the estimate is not finite'
            case 3:
                return f'unstable: pole modulus {self.pole_modulus[index]:.3f}'
            case 4:
                return (
                    f'the input excites order {self.excitation_order[index]:.0f}, '
                    f'{p.count} parameters need {p.count}'
                )
            case 5:
                return f'ill-conditioned information: {self.information_condition[index]:.1e}'
            case 6:
                low, high = p.trust_band
                return (
                    f'response uncertain by {100.0 * self.response_deviation[index]:.0f} % '
                    f'between {low:g} and {high:g} Hz, {100.0 * p.trust_deviation:g} % allowed'
                )
            case 7 if not np.isfinite(self.model_error[index]):
                low, high = p.trust_band
                return (
                    f'too little input between {low:g} and {high:g} Hz for its noise: the response '
                    'there may be anything'
                )
            case 7:
                low, high = p.trust_band
                return (
                    f'the residual still answers to the input: response off by '
                    f'{100.0 * self.model_error[index]:.0f} % between {low:g} and {high:g} Hz, '
                    f'{100.0 * p.trust_error:g} % allowed'
                )
            case 8:
                return f'residual not white: Q/h {self.whiteness[index]:.1f}'
            case _:
                return ''

    @property
    def reasons(self) -> NDArray[np.object_]:
        """The reason of every item, object array (shape) of str."""
        out = np.empty(self.failed.shape, dtype=object)
        for index in np.ndindex(self.failed.shape):
            out[index] = self.reason(index)
        return out


def judge(
    parameters: IdentifierParameters,
    updates: Array,
    theta: Array,
    pole_modulus: Array,
    excitation_order: Array,
    information: tuple[Array, Array],
    response_deviation: Array,
    model_error: Array,
    whiteness: Array,
) -> Verdict:
    """Run the checks on arrays of one shape (theta: (*shape, p))."""
    p = parameters
    finite = np.asarray(np.logical_and.reduce(np.isfinite(theta), axis=-1))
    eigenvalue, condition = information
    failed = _failed(
        updates < p.trust_samples * p.count, finite, pole_modulus, excitation_order, condition,
        response_deviation, model_error, whiteness, np.array([
            p.trust_pole_modulus, p.count, p.trust_condition, p.trust_deviation, p.trust_error,
            p.trust_whiteness or np.inf,
        ]),
    )  # fmt: skip
    return Verdict(
        p, updates, finite, pole_modulus, excitation_order, eigenvalue, condition,
        response_deviation, model_error, whiteness, np.asarray(failed),
    )  # fmt: skip
