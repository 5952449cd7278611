# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Simulated runs that can show nothing: the first line after the phases says why, exit code 3, no figure in dB.

Truth: the scenario, in which nothing shakes the payload, or in which the law never acts.
"""

import json

import pytest

FIGURES = ('attenuation', 'attenuation_open_loop')
NO_DISTURBANCE = 'disturbance={kind: none}'
NO_CONTROL = (
    'phases=[{phase: CALIBRATE}, {phase: IDENTIFY, start: 0.5}, {phase: STANDBY, start: 1.5}]'
)


@pytest.mark.usefixtures('no_figures')
@pytest.mark.parametrize(
    ('settings', 'said'),
    [
        ([NO_DISTURBANCE], 'There was no disturbance, so there is nothing to attenuate'),
        ([NO_CONTROL, 'analysis={}'], 'Nothing is under control: the scenario has no phase'),
    ],
)
def test_a_run_that_can_show_nothing(satvib, tmp_path, settings, said):
    changes = [part for setting in settings for part in ('--set', setting)]
    code, out, err = satvib('simulate', 'quick_3dof', *changes, '--folder', 'run')
    assert code == 3, err
    shown = [line for line in out.splitlines() if not line.startswith('simulate ')]
    assert shown[0].startswith(f'THIS RUN IS NO RESULT: {said}')
    assert 'attenuation in dB' not in out
    assert 'worse' not in out
    result = json.loads((tmp_path / 'run/result.json').read_text())
    assert result['shortfalls'][0].startswith(said)
    assert [s[name][kind] for s in result['struts'] for name in FIGURES for kind in s[name]] == (
        [None] * 24
    )
    assert result['line_of_sight']['open_loop'] is None
    page = (tmp_path / 'run/report.html').read_text()
    assert said in page
    assert '<h2>Attenuation</h2>' not in page
