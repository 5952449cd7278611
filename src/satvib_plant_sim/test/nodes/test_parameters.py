# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The parameters of the plant_sim node."""

import pytest
from satvib_common.errors import SatvibError
from satvib_plant_sim.nodes.parameters import PlantParameters


def test_parameters_build_a_rig_and_a_disturbance():
    """Truth: the values given."""
    parameters = PlantParameters(
        rig='paper_1dof',
        rig_overrides=('payload.mass=4', 'acquisition.hold=linear', ''),
        disturbance='{kind: sine, amplitude: 1, frequency: 10, start: 5.0}',
    )
    assert parameters.load_rig().payload.mass == 4.0
    assert parameters.load_rig().acquisition.hold == 'linear'
    assert parameters.make_disturbance().tones() == (10.0,)
    assert PlantParameters.from_mapping(parameters.to_mapping()) == parameters


@pytest.mark.parametrize(
    ('changes', 'message'),
    [
        ({'rig_overrides': ('payload.mass',)}, 'rig_overrides payload.mass: key=value is expected'),
        ({'disturbance': '{kind: quake}'}, "disturbance: kind: 'quake' is not known"),
        ({'disturbance': '{kind: '}, 'disturbance: line 1: not YAML'),
        ({'seed': -1}, 'seed: -1 is less than 0'),
        ({'lockstep_timeout': 0.0}, 'lockstep_timeout: 0.0 is not above 0.0 s'),
    ],
)
def test_wrong_parameters_are_refused_by_name(changes, message):
    """Truth: the message names the parameter."""
    with pytest.raises(SatvibError) as refused:
        PlantParameters(**changes)
    assert message in str(refused.value)
