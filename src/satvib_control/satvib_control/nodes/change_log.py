# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A line in the log when something changes that a person must know: phase, fault, model, a voltage that is lost."""

import re
from collections.abc import Callable, Sequence
from typing import Any

from satvib_common.phases import Phase
from satvib_common.struts.applied import TEXTS, Applied, applied_of

from satvib_control.core.output import ControllerOutput

_FIGURE = re.compile(r'[\d.]+')


class ChangeLog:
    """The log of one controller.

    Args:
        log: of the node.
        places: of the struts in the arrays of the core.
        latched: says who has latched 0 V, and how that ends.
    """

    def __init__(
        self, log: Any, places: Sequence[tuple[int, ...]], latched: Callable[[], str]
    ) -> None:
        self._log, self._places, self._latched = log, places, latched
        self._phase: object = None
        self._fault, self._lost = False, 0
        self._model: object = None

    def see(self, output: ControllerOutput, samples: Sequence[Any]) -> None:
        """Compare a sample with the one before."""
        k = output.sequence
        if output.phase is not self._phase:
            self._phase = output.phase
            self._log.info(f'sample {k}: {output.phase.name}')
        fault = bool(output.fault.any())
        if fault != self._fault:
            self._fault = fault
            if fault:
                reasons = {output.reason_text(place) for place in self._places} - {''}
                self._log.error(f'sample {k}: {"; ".join(sorted(reasons))}')
            else:
                self._log.info(f'sample {k}: the faults are released')
        state = max(applied_of(sample.applied_state) for sample in samples)
        lost = state if state >= Applied.SILENT else 0  # silence may become a latch
        if lost != self._lost:
            self._lost = lost
            if lost:
                what = self._latched() if state == Applied.LATCHED else TEXTS[state]
                self._log.warning(f'sample {k}: {what}')
            else:
                self._log.info(f'sample {k}: the voltage reaches its coil again')

    def see_model(self, k: int, phase: Phase, model: Any) -> None:
        """Take the identified model (an IirParameters) with which sample k of a phase begins.

        One line for each phase, and for each change of order or trust; in IDENTIFY models come several times a second.
        """
        order = f'{len(model.a)} poles, {len(model.b)} coefficients, delay {model.delay}'
        trust = (
            'trusted' if model.converged else f'not trusted: {model.reason or "no reason given"}'
        )
        kind = phase, order, _FIGURE.sub('', trust)  # the same reason has other figures each time
        if kind == self._model:
            return
        self._model = kind
        taken = f'model of sample {model.sequence} taken' if model.converged else 'model not taken'
        self._log.info(f'sample {k}: {taken}: {order}, {trust}')
