# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the identifiers of a run would have found with perfect sensors: the nearest thing to true parameters.

A five-parameter model of a plant with filters, coupling and a coil has no true parameters; what the same estimator
finds from the same excitation without noise and quantization is what noise keeps it from.
"""

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_plant_sim.rig.any_rig import without_noise

from satvib_experiment.recording.recording import Recording
from satvib_experiment.twin.closed_loop import ClosedLoop


def perfect_parameters(recording: Recording) -> Array | None:
    """Parameters (struts, n + m) at the end of the first IDENTIFY, without noise.

    None when nothing was identified, or the run cannot be simulated here.

    Args:
        recording: a run that knows its scenario and rig.
    """
    scenario, rig = recording.scenario, recording.rig
    spans = [end for phase, _, end in recording.phases() if phase is Phase.IDENTIFY]
    if scenario is None or rig is None or not spans:
        return None
    try:
        loop = ClosedLoop(scenario, [without_noise(rig)])
    except SatvibError:  # recorded with something that is not here, a law of one's own for instance
        return None
    identification = None
    for step in loop.steps():
        if step.sequence * recording.sample_period >= spans[0]:
            break
        identification = step.identification
    if identification is None:
        return None
    return np.concatenate([identification.a, identification.b], axis=-1)
