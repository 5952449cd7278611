# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What happened in the loop at one sample."""

from dataclasses import dataclass

from satvib_common.phases import Phase
from satvib_control.core.output import ControllerOutput
from satvib_ident.identifier import Identification
from satvib_plant_sim.plant.observation import Sample, Truth


@dataclass(frozen=True)
class LoopStep:
    """One sample of the loop; arrays are (*shape, struts), as the cores give them.

    Attributes:
        sequence: index of the sample.
        phase: of the sample.
        sample: what the sensors measured.
        identification: what the identifiers know after the sample.
        output: what the controllers answered.
        truth: what the plant did until the next sample.
    """

    sequence: int
    phase: Phase
    sample: Sample
    identification: Identification
    output: ControllerOutput
    truth: Truth
