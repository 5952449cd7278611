# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The lines of the change log. Truth: what was put in, sample by sample; a line for each change and no other."""

import logging
from types import SimpleNamespace

import pytest
from satvib_common.phases import Phase, PhasePlan
from satvib_common.struts.applied import TEXTS, Applied
from satvib_control.core.controller import ControllerCore
from satvib_control.nodes.change_log import ChangeLog


@pytest.fixture
def changes(caplog):
    """A change log of one strut, and its lines as level and text."""
    caplog.set_level(logging.INFO)
    log = ChangeLog(logging.getLogger('changes'), [()], lambda: 'latched by a plant')
    return log, lambda: [(r.levelname, r.getMessage()) for r in caplog.records]


def model(sequence, converged=True, reason='', poles=2):
    return SimpleNamespace(
        sequence=sequence, a=[0.0] * poles, b=[0.0] * 3, delay=1, converged=converged, reason=reason
    )


def test_a_model_is_one_line_for_each_phase_and_each_change(changes):
    log, lines = changes
    log.see_model(50, Phase.IDENTIFY, model(49, converged=False, reason='9 samples of 50'))
    log.see_model(100, Phase.IDENTIFY, model(99, converged=False, reason='35 samples of 50'))
    log.see_model(150, Phase.IDENTIFY, model(149))
    log.see_model(200, Phase.IDENTIFY, model(199))
    log.see_model(250, Phase.CONTROL, model(249))
    log.see_model(300, Phase.CONTROL, model(299))
    log.see_model(350, Phase.CONTROL, model(349, poles=3))
    order = '2 poles, 3 coefficients, delay 1'
    assert lines() == [
        ('INFO', f'sample 50: model not taken: {order}, not trusted: 9 samples of 50'),
        ('INFO', f'sample 150: model of sample 149 taken: {order}, trusted'),
        ('INFO', f'sample 250: model of sample 249 taken: {order}, trusted'),
        (
            'INFO',
            'sample 350: model of sample 349 taken: 3 poles, 3 coefficients, delay 1, trusted',
        ),
    ]


def test_phases_faults_and_lost_voltages_are_lines(changes, settings):
    """The outputs are those of a real core: CONTROL from sample 2 on, stopped at 3, reset before 5. No state is 255."""
    log, lines = changes
    core = ControllerCore(settings(law='off'))
    plan = PhasePlan((Phase.STANDBY, Phase.CONTROL), (0, 2))
    states = [255] + [Applied.APPLIED] * 5 + [Applied.SILENT] * 2 + [Applied.APPLIED]
    for k, state in enumerate(states):
        if k == 3:
            core.stop()
        if k == 5:
            core.reset()
        log.see(core.step(k, plan, 0.0, 0.0), [SimpleNamespace(applied_state=state)])
    found = lines()
    assert [level for level, _ in found] == ['INFO', 'INFO', 'ERROR', 'INFO', 'WARNING', 'INFO']
    assert [text.partition(':')[0] for _, text in found] == [
        f'sample {k}' for k in (0, 2, 3, 5, 6, 8)
    ]
    texts = [text.partition(': ')[2] for _, text in found]
    assert texts[:2] == ['STANDBY', 'CONTROL']
    assert 'stopped' in texts[2]
    assert texts[4] == TEXTS[Applied.SILENT]
