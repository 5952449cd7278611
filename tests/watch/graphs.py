# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Graphs to look at, started by hand, node by node."""

RATE = 100.0  # Hz, of the rig paper_3dof


def begin(start, above: str = '', struts: int = 3, law: str = 'velocity_feedback'):
    """A plant and its controllers, in real time; velocity feedback needs no model."""
    shake = '{kind: sine, frequency: 10.0, amplitude: 1.0}'
    plant = start('satvib_plant_sim', 'plant_sim', above or '/', rig='paper_3dof', lockstep=False,
                  disturbance=shake, command_timeout=1.0)  # fmt: skip
    controllers = [
        start('satvib_control', 'strut_controller', f'{above}/strut_{i + 1}', law=law,
              sample_rate=RATE, lockstep=False, strut=i)
        for i in range(struts)
    ]  # fmt: skip
    return plant, controllers
