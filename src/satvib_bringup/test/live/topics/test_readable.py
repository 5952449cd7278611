# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Messages as text. Truth: the lines below, written by hand from the definitions of the messages."""

import pytest

pytest.importorskip('satvib_msgs', reason='the workspace is not built and sourced')
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from satvib_bringup.live.topics.readable import text_of

from satvib_msgs.msg import IirParameters, Schedule, StrutProgress


def test_a_phase_has_its_name():
    assert text_of(StrutProgress(phase=4, sequence=7)).splitlines()[-3:] == [
        'sequence: 7',
        'phase: 4 (CONTROL)',
        'upper_rms: 0',
    ]
    assert 'phases: [0 (STANDBY), 2 (IDENTIFY)]' in text_of(Schedule(phases=[0, 2]))
    assert 'phase: 99' in text_of(StrutProgress(phase=99)).splitlines()  # no such phase


def test_a_long_array_is_cut_and_nested_messages_are_indented():
    assert 'a: [0, 1, 2, 3, 4, 5, 6, 7, ... 20 in all]' in text_of(
        IirParameters(a=[float(i) for i in range(20)])
    )
    status = DiagnosticStatus(level=DiagnosticStatus.WARN, name='x', message='m')
    assert text_of(DiagnosticArray(status=[status])).splitlines()[-5:] == [
        '  - level: 1 (WARN)',
        '    name: x',
        '    message: m',
        '    hardware_id: ',
        '    values: []',
    ]
