# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Exact responses of a rig: continuous, sampled for one strut, and sampled for all struts."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_plant_sim.responses.all_struts import (
        RigResponse,
        SampledRig,
        rig_response,
        sampled_rig,
    )
    from satvib_plant_sim.responses.continuous import (
        StateSpace,
        frequency_response,
        source_transfer,
        state_space,
    )
    from satvib_plant_sim.responses.images import (
        hold_response,
        lines,
        payload_weight,
        weight_table,
    )
    from satvib_plant_sim.responses.one_strut import (
        SampledModel,
        discrete_strut_model,
        strut_response,
    )
    from satvib_plant_sim.responses.periodic import best_command, periodic_response
    from satvib_plant_sim.responses.transmission import plate_responses, transmissibility

__all__ = [
    'RigResponse',
    'SampledModel',
    'SampledRig',
    'StateSpace',
    'best_command',
    'discrete_strut_model',
    'frequency_response',
    'hold_response',
    'lines',
    'payload_weight',
    'periodic_response',
    'plate_responses',
    'rig_response',
    'sampled_rig',
    'source_transfer',
    'state_space',
    'strut_response',
    'transmissibility',
    'weight_table',
]
__getattr__, __dir__ = door(__name__, __file__)
