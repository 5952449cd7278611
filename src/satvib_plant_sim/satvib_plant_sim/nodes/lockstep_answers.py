# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Collects the voltages of one sample, one per strut, for lockstep."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from satvib_common.errors import RunError, SatvibError

ANOTHER_PLANT = (
    'voltages for samples that this plant has not published: another source of samples is running; '
    'stop one of them'
)


class Answers:
    """The voltages of the present sample.

    Args:
        names: of the struts.
        others: names who else answers for a strut, or is in the plant's place.
        newcomers: the same, with time for who has just started; None: as `others`.
    """

    def __init__(
        self,
        names: Sequence[str],
        others: Callable[[int], str] = lambda _: '',
        newcomers: Callable[[int], str] | None = None,
    ) -> None:
        self.names, self._others, self._newcomers = tuple(names), others, newcomers or others
        self.voltage = np.zeros(len(self.names))
        self._answered = [-1] * len(self.names)

    def has(self, strut_index: int, k: int) -> bool:
        """Whether a strut has answered sample k."""
        return self._answered[strut_index] >= k

    def take(self, strut_index: int, sequence: int, voltage: float, k: int) -> bool:
        """Take a voltage for the present sample k; True when every strut has answered k.

        Raises:
            RunError: an answer to a sample that is not published yet, so from another run.
            SatvibError: a voltage that is not a number.
        """
        name = self.names[strut_index]
        if sequence > k:
            raise RunError(
                f'{name}: a voltage for sample {sequence} before that sample was published: a '
                'controller of another run is alive; stop it, or use another ROS_DOMAIN_ID'
                + (f'; {others}' if (others := self._newcomers(strut_index)) else '')
            )
        if sequence < k or self._answered[strut_index] == k:
            return False  # a controller that was started again sends an old answer
        if not math.isfinite(voltage):
            raise SatvibError(
                f'{name}: the voltage of sample {sequence} is {voltage}; the run ends with all '
                'struts at 0 V; correct the node that publishes it'
            )
        self._answered[strut_index] = k
        self.voltage[strut_index] = voltage
        return self._answered.count(k) == len(self.names)

    def missing(self, k: int) -> list[str]:
        """Names of the struts that have not answered sample k."""
        return [name for name, last in zip(self.names, self._answered, strict=True) if last != k]

    def check(self, k: int, silence: float, limit: float) -> None:
        """End the run when sample k has waited for longer (s) than allowed.

        Raises:
            RunError: it has; the struts are named.
        """
        if silence > limit:
            missing = self.missing(k)
            others = next(filter(None, (self._others(self.names.index(n)) for n in missing)), '')
            raise RunError(
                f'no voltage for sample {k} from {", ".join(missing)} within {limit:g} s; '
                + (others or 'is the controller there, and its identifier?')
            )
