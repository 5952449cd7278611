# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What became of one sample in a controller."""

from dataclasses import dataclass
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

    def fields(self, index: tuple[int, ...] = ()) -> dict[str, Any]:
        """The fields of satvib_msgs/ControllerState that the controller knows, for one item, as plain values."""
        found: dict[str, Any] = {
            'sequence': self.sequence,
            'phase': int(self.phase),
            'law': self.law,
            'reason': self.reason_text(index),
            'missed_samples': self.missed_samples,
        }
        for name in STATE_FIELDS:
            found[name] = float(getattr(self.state, name)[index])
        for name in ('voltage', 'output', 'reference', 'upper_rms', 'bias_upper', 'bias_lower'):
            found[name] = float(getattr(self, name)[index])
        for name in ('saturated', 'fault', 'adapting'):
            found[name] = bool(getattr(self, name)[index])
        return found
