# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What became of one sample in a controller."""

from dataclasses import dataclass, fields
from typing import Any

from satvib_common.arrays import Array, Mask
from satvib_common.phases import Phase

from satvib_control.laws.base import STATE_FIELDS, LawState
from satvib_control.laws.reasons import text_of


@dataclass(frozen=True)
class ControllerOutput:
    """What became of one sample; arrays of `shape`.

    Attributes:
        sequence: index of the sample.
        phase: phase of the sample.
        law: name of the law.
        voltage: V; what the guard let through.
        output: V; what was asked of the guard.
        saturated: bool; the guard changed it.
        fault: bool; latched, the voltage is 0.
        state: what the law shows.
        reference: the law's reference in m/s^2, or the excitation in V in IDENTIFY.
        upper_rms: m/s^2; RMS without bias over the recent window.
        bias_upper: m/s^2.
        bias_lower: m/s^2.
        adapting: bool; the gains moved on this sample.
        reason: codes of `satvib_control.laws.reasons`.
        missed_samples: samples lost so far.
    """

    sequence: int
    phase: Phase
    law: str
    voltage: Array
    output: Array
    saturated: Mask
    fault: Mask
    state: LawState
    reference: Array
    upper_rms: Array
    bias_upper: Array
    bias_lower: Array
    adapting: Mask
    reason: Any
    missed_samples: int

    def reason_text(self, index: tuple[int, ...] = ()) -> str:
        """Text of the reason of one item; empty when all is well."""
        return text_of(self.reason[index])

    def figures(self) -> dict[str, Any]:
        """Every figure of a strut, by the name of its field in satvib_msgs/ControllerState; arrays of `shape`.

        The node's message and the twin's recording are filled from this one list. `reason` is a code.
        """
        law = {name: getattr(self.state, name) for name in STATE_FIELDS}
        return law | {name: getattr(self, name) for name in OUTPUT_FIELDS}

    def voltages(self) -> dict[str, Any]:
        """Every figure of satvib_msgs/VcaVoltage, by the name of its field; arrays of `shape`."""
        return {name: getattr(self, name) for name in VOLTAGE_FIELDS}

    def fields(self, index: tuple[int, ...] = ()) -> dict[str, Any]:
        """The fields of satvib_msgs/ControllerState that the controller knows, for one item, as plain values."""
        found = {name: values.item(*index) for name, values in self.figures().items()}
        return found | {
            'sequence': self.sequence,
            'phase': int(self.phase),
            'law': self.law,
            'reason': self.reason_text(index),
            'missed_samples': self.missed_samples,
        }


# what all struts of a controller have in common
_SHARED = {'sequence', 'phase', 'law', 'state', 'missed_samples'}
OUTPUT_FIELDS = tuple(f.name for f in fields(ControllerOutput) if f.name not in _SHARED)
VOLTAGE_FIELDS = ('voltage', 'saturated', 'fault')
