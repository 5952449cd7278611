# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where the executables of this package begin, see `satvib_common.process.start`."""

from satvib_common.process.start import starter

strut = starter('satvib_bringup.nodes.strut')
single = starter('satvib_bringup.nodes.single')
recorder = starter('satvib_bringup.nodes.recorder_node')
experiment = starter('satvib_bringup.nodes.experiment_node')
schedule = starter('satvib_bringup.nodes.schedule_node')
replay = starter('satvib_bringup.nodes.replay_node')
satvib = starter('satvib_bringup.cli.main', code=130, line='satvib: interrupted', hand_back=True)

if __name__ == '__main__':
    satvib()
