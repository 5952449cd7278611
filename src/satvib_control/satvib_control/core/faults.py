# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What stops the voltage of a strut for good, until `reset`, and the reason that is shown."""

import numpy as np
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.guard import Guarded

from satvib_control.core.vibration_watch import Verdict
from satvib_control.laws.reasons import reason

NOT_FINITE = reason('fault: the law asked for a voltage that is not finite')
LOST = reason('0 V: the upper acceleration is missing')
LOST_LONG = reason('fault: the upper acceleration was missing for too long')
RESTLESS = reason('fault: the upper sensor was not at rest in CALIBRATE')
BIASED = reason('fault: the bias of the upper sensor in CALIBRATE is more than bias_limit')
DIVERGED = reason('fault: the law made the strut louder than its open loop, three times')
BLIND = reason('fault: the law drove the upper sensor to the ends of its range, three times')
STOPPED = reason('fault: stopped from outside')


class Faults:
    """The faults of a batch of struts. The guard latches them; this gives and keeps the causes.

    Args:
        shape: leading axes.

    Attributes:
        alarmed: something is lost, stopped or at fault somewhere; else nothing here needs to be computed.
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape
        self.alarmed = False
        self._biasless = np.zeros(shape, dtype=np.int64)
        self.reset()

    def reset(self) -> None:
        """Forget all causes but a bias that was not measured: only another CALIBRATE removes that."""
        self._stopped = np.zeros(self.shape, dtype=np.int64)  # codes of why; 0: it is not
        self._lost = np.zeros(self.shape, dtype=np.int64)  # upper samples lost in a row
        self._reason = self._biasless.copy()
        self.alarmed = bool(self._biasless.any())

    @property
    def biasless(self) -> Mask:
        """Where no bias is known (shape), because CALIBRATE did not give a plausible one."""
        return self._biasless != 0

    def stop(self, mask: Mask | bool = True, why: int = STOPPED) -> None:
        """Stop from the next sample on where `mask` (shape) holds; `why`: code of the reason."""
        self._stopped = np.where(np.asarray(mask) & (self._stopped == 0), why, self._stopped)
        self.alarmed = self.alarmed or bool(self._stopped.any())

    def check_bias(
        self, bias: Array, deviation: Array, bias_limit: float, deviation_limit: float
    ) -> None:
        """Stop where CALIBRATE gave no bias to subtract: not at rest, or an offset that no sensor has (shape, m/s^2).

        Such a fault is kept through `reset`, until the next call finds a bias.
        """
        biasless = np.where(np.abs(bias) > bias_limit, BIASED, 0)
        biasless = np.where(deviation > deviation_limit, RESTLESS, biasless)
        self._biasless = biasless
        self._reason = np.where(biasless != 0, biasless, self._reason)
        self.alarmed = self.alarmed or bool(biasless.any())

    def causes(self, valid: Mask, verdict: Integers, blind: Mask, loss_limit: int) -> Integers:
        """Take a sample; give what stops the voltage for good, as codes (shape); 0 for nothing.

        Args:
            valid: shape, the upper acceleration was measured.
            verdict: shape, of the vibration watch.
            blind: shape, the clipping watch has given the law up.
            loss_limit: missing samples in a row that stop the strut.
        """
        self._lost = np.where(valid, 0, self._lost + 1)
        cause = np.where(self._lost >= loss_limit, LOST_LONG, 0)
        cause = np.where(blind, BLIND, cause)
        cause = np.where(verdict == Verdict.FAILED, DIVERGED, cause)
        cause = np.where(self._stopped != 0, self._stopped, cause)
        return np.where(self._reason != 0, self._reason, cause)

    def explain(
        self, guarded: Guarded, valid: Mask, why: Integers, stop: Integers | None
    ) -> Integers:
        """Remember the cause of a new fault, and give the reasons (shape).

        Args:
            guarded: what the guard let through.
            valid: shape, the upper acceleration was measured.
            why: shape, reasons without a fault.
            stop: of `causes`; None: it was not asked.
        """
        cause = NOT_FINITE if stop is None else np.where(stop != 0, stop, NOT_FINITE)
        new = guarded.fault & (self._reason == 0)
        self._reason = np.where(new, cause, self._reason)
        stopped = self._stopped != 0
        self.alarmed = bool((stopped | guarded.fault | (self._lost > 0)).any())
        return np.where(guarded.fault, self._reason, np.where(valid, why, LOST))
