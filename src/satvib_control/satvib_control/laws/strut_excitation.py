# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The excitation of each strut: the voltage of IDENTIFY and the reference u_c of ADAPT."""

import dataclasses
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.settings_text import parse_settings
from satvib_ident.excitation.factory import SIGNALS, make_excitation

from satvib_control.laws.parameters import LawParameters


class StrutSignals:
    """One signal for each strut on the last axis of `shape`.

    Args:
        name: of the signal.
        amplitude: in the unit of the signal.
        frequencies: Hz, for signals that have some.
        parameters: of the controller.
        shape: leading axes.
    """

    def __init__(
        self,
        name: str,
        amplitude: float,
        frequencies: tuple[float, ...],
        parameters: LawParameters,
        shape: tuple[int, ...] = (),
    ) -> None:
        p = parameters
        self.shape = shape
        options: dict[str, Any] = {'amplitude': amplitude, 'dt': 1.0 / p.sample_rate}
        cls = SIGNALS.get(name)
        if cls is not None and 'frequencies' in {f.name for f in dataclasses.fields(cls)}:
            options['frequencies'] = frequencies
        options |= parse_settings(p.excitation_options, 'excitation_options')
        count = shape[-1] if shape else 1
        struts = max(p.struts, p.strut + count)
        self.signals = [
            make_excitation(name, **(options | {'strut': p.strut + i, 'struts': struts}))
            for i in range(count)
        ]

    def at(self, index: int) -> Array:
        """Give the value (shape) at sample `index` of the phase, in the unit of `amplitude`."""
        values = np.array([signal.in_turn(index) for signal in self.signals])
        return np.broadcast_to(values if self.shape else values[0], self.shape)
