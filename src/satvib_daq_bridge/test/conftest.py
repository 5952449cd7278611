# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Channels that the tests share."""

import pytest
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.simulated.channels_from_rig import channels_of
from satvib_plant_sim.rig.rig import load_rig


@pytest.fixture
def make_channels():
    """Channels of the paper's rigs, three struts or one, with changes."""

    def make(struts=3, **changes):
        name = 'paper_3dof' if struts == 3 else 'paper_1dof'
        return parse_channels(channels_of(load_rig(name), **changes), 'test')

    return make
