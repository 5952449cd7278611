# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a model is trusted, and why not: the first of the checks that fails.

What is not known (NaN: an estimator without covariance, a window that is not full) fails no check but the one on poles.
"""

from dataclasses import dataclass, fields, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array, Integers, Mask, every
from satvib_common.kernels.compile import kernel

from satvib_ident.parameters import IdentifierParameters


class Check(IntEnum):
    """The checks, in their order.

    SAMPLES: enough samples are used, at least `trust_samples` per parameter.
    FINITE: the estimate is finite.
    POLES: the model is stable, as the struts are: pole modulus below `trust_pole_modulus`.
    EXCITATION: the input was persistently exciting of order n + m at the last sample used.
    CONDITION: the information matrix is regular: condition below `trust_condition`.
    DEVIATION: the frequency response is known in `trust_band`: relative deviation below `trust_deviation`.
    ERROR: the residual, compared with the input, says that the response is right in that band: relative error below
        `trust_error`. It is infinite where the input has too little power to say so.
    WHITENESS: the residual is white: Q / h at most `trust_whiteness`, if asked for.
    """

    PASSED = 0
    SAMPLES = 1
    FINITE = 2
    POLES = 3
    EXCITATION = 4
    CONDITION = 5
    DEVIATION = 6
    ERROR = 7
    WHITENESS = 8


class Limit(IntEnum):
    """Places of the limits of the checks."""

    MODULUS = 0
    ORDER = 1
    CONDITION = 2
    DEVIATION = 3
    ERROR = 4
    WHITENESS = 5


@kernel('void(b1, b1, f8, f8, f8, f8, f8, f8, f8[:], i8[:])', '(),(),(),(),(),(),(),(),(l)->()')
def _failed(few, finite, modulus, order, condition, deviation, error, colour, limits, out):
    """Give the first check that fails, or PASSED."""
    if few:
        out[0] = Check.SAMPLES
    elif not finite:
        out[0] = Check.FINITE
    elif not modulus < limits[Limit.MODULUS]:
        out[0] = Check.POLES
    elif order < limits[Limit.ORDER]:
        out[0] = Check.EXCITATION
    elif condition >= limits[Limit.CONDITION]:
        out[0] = Check.CONDITION
    elif deviation >= limits[Limit.DEVIATION]:
        out[0] = Check.DEVIATION
    elif error >= limits[Limit.ERROR]:
        out[0] = Check.ERROR
    elif colour > limits[Limit.WHITENESS]:
        out[0] = Check.WHITENESS
    else:
        out[0] = Check.PASSED


_PASSED = int(Check.PASSED)  # NumPy asks a member for what it is, each time


@dataclass(frozen=True, eq=False, kw_only=True)
class Trust:
    """What was measured, arrays of one shape, and which check failed first (`Check`)."""

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
        """The model is trusted, (shape)."""
        return self.failed == _PASSED

    def renewed(self, fresh: 'Trust', mask: Mask) -> 'Trust':
        """Give the items of `fresh` where `mask` (shape) holds, and the present ones elsewhere."""
        if every(mask):
            return fresh
        names = (f.name for f in fields(self) if f.name != 'parameters')
        merged = {n: np.where(mask, getattr(fresh, n), getattr(self, n)) for n in names}
        return replace(fresh, **merged)

    def reason(self, index: tuple[int, ...] = ()) -> str:
        """Why the model of one item is not trusted; '' when it is."""
        p = self.parameters
        low, high = p.trust_band
        match Check(int(self.failed[index])):
            case Check.SAMPLES:
                return f'{self.updates[index]:.0f} samples used of {p.trust_samples * p.count}'
            case Check.FINITE:
                return 'the estimate is not finite'
            case Check.POLES:
                return f'unstable: pole modulus {self.pole_modulus[index]:.3f}'
            case Check.EXCITATION:
                return (
                    f'the input excites order {self.excitation_order[index]:.0f}, '
                    f'{p.count} parameters need {p.count}'
                )
            case Check.CONDITION:
                return f'ill-conditioned information: {self.information_condition[index]:.1e}'
            case Check.DEVIATION:
                return (
                    f'response uncertain by {100.0 * self.response_deviation[index]:.0f} % '
                    f'between {low:g} and {high:g} Hz, {100.0 * p.trust_deviation:g} % allowed'
                )
            case Check.ERROR if not np.isfinite(self.model_error[index]):
                return (
                    f'too little input between {low:g} and {high:g} Hz for its noise: the response '
                    'there may be anything'
                )
            case Check.ERROR:
                return (
                    f'the residual still answers to the input: response off by '
                    f'{100.0 * self.model_error[index]:.0f} % between {low:g} and {high:g} Hz, '
                    f'{100.0 * p.trust_error:g} % allowed'
                )
            case Check.WHITENESS:
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
    *,
    updates: Array,
    theta: Array,
    pole_modulus: Array,
    excitation_order: Array,
    information: tuple[Array, Array],
    response_deviation: Array,
    model_error: Array,
    whiteness: Array,
) -> Trust:
    """Run the checks on arrays of one shape (theta: (*shape, p))."""
    p = parameters
    finite = np.asarray(np.logical_and.reduce(np.isfinite(theta), axis=-1))
    eigenvalue, condition = information
    limits = np.zeros(len(Limit))
    limits[Limit.MODULUS] = p.trust_pole_modulus
    limits[Limit.ORDER] = p.count
    limits[Limit.CONDITION] = p.trust_condition
    limits[Limit.DEVIATION] = p.trust_deviation
    limits[Limit.ERROR] = p.trust_error
    limits[Limit.WHITENESS] = p.trust_whiteness or np.inf
    failed = _failed(
        updates < p.trust_samples * p.count, finite, pole_modulus, excitation_order, condition,
        response_deviation, model_error, whiteness, limits,
    )  # fmt: skip
    return Trust(
        parameters=p,
        updates=updates,
        finite=finite,
        pole_modulus=pole_modulus,
        excitation_order=excitation_order,
        information_eigenvalue=eigenvalue,
        information_condition=condition,
        response_deviation=response_deviation,
        model_error=model_error,
        whiteness=whiteness,
        failed=np.asarray(failed),
    )
