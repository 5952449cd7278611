# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Excitation strut by strut: the voltage of IDENTIFY and the reference u_c of ADAPT."""

import dataclasses
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import parse_yaml
from satvib_ident.excitation import SIGNALS, make_excitation

from satvib_control.laws.parameters import LawParameters


def parse_options(options: tuple[str, ...]) -> dict[str, Any]:
    """Read 'key=value' pairs; values as YAML has them.

    Raises:
        SatvibError: a pair without an equals sign.
    """
    found: dict[str, Any] = {}
    for option in options:
        key, equals, text = option.partition('=')
        if not equals:
            raise SatvibError(f'excitation_options: {option!r} is not key=value')
        found[key.strip()] = parse_yaml(text, f'excitation_options: {key.strip()}')
    return found


class StrutSignals:
    """One signal per strut on the last axis of `shape`; `at(i)` has `shape` and the unit of `amplitude`."""

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
        options |= parse_options(p.excitation_options)
        count = shape[-1] if shape else 1
        struts = max(p.struts, p.strut + count)
        self.signals = [
            make_excitation(name, **(options | {'strut': p.strut + i, 'struts': struts}))
            for i in range(count)
        ]

    def at(self, index: int) -> Array:
        """Value at sample `index` of the phase."""
        values = np.array([signal.at(index) for signal in self.signals])
        return np.broadcast_to(values if self.shape else values[0], self.shape)
