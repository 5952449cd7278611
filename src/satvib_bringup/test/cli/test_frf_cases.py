# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib frf`: what it prints and leaves, of a scenario, a run and a file; what it refuses in one line."""

import csv
import json

import numpy as np
import pytest
from satvib_experiment.frf import figures

QUICK = ('--duration', '6', '--period', '2', '--low', '2')


@pytest.mark.usefixtures('no_figures')  # of reports
def test_a_scenario_and_its_own_experiments(satvib, tmp_path, monkeypatch):
    """Truth: the curves that a rig of three struts has, and the same numbers from the experiment run by `simulate`."""
    code, out, err = satvib('frf', 'soft_3dof', *QUICK, '--folder', 'one')
    assert code == 0, err
    found = json.loads((tmp_path / 'one/frf.json').read_text())
    assert [(c['quantity'], c['loop']) for c in found['curves']] == (
        [('transmissibility', 'open')] * 6
        + [('transmissibility', 'velocity_feedback')] * 6
        + [('path', 'open')] * 9
    )
    assert np.array(found['coupling']['ratio']).diagonal().tolist() == [1.0] * 3
    for name in ('transmissibility', 'motions', 'paths', 'coupling'):
        assert (tmp_path / f'one/figures/{name}.png').read_bytes().startswith(b'\x89PNG')
        assert f'{name}.png' in out
    rows = list(csv.DictReader((tmp_path / 'one/frf.csv').open()))
    assert len(rows) == sum(c['lines'] for c in found['curves'])
    assert {float(r['magnitude']) > 0.0 for r in rows} == {True}
    for curve in found['curves']:
        own = [
            (float(r['coherence']), float(r['frequency'])) for r in rows
            if all(r[key] == curve[key] for key in ('quantity', 'loop', 'output', 'input'))
        ]  # fmt: skip
        least, at = min(own)
        assert curve['coherence_least'] == pytest.approx(least, rel=1e-6)
        assert curve['coherence_least_frequency'] == pytest.approx(at)
    # a line for each phase of the two experiments, then the tables
    assert out[: out.index('transmissibility')].count('\n') < 12
    assert (
        '– (isolation, roll-off; tilt x, tilt y): the base does not move in that way alone' in out
    )
    code, _, err = satvib('frf', 'one')
    assert (code, err.count('\n')) == (2, 1)
    assert (
        'holds frequency responses (frf.json), no recording; ./satvib simulate one/base.yaml' in err
    )
    code, _, err = satvib('simulate', 'one/base.yaml', '--folder', 'run')
    assert code == 0, err
    monkeypatch.setattr(figures, 'draw_figures', lambda *_: ())  # the numbers count
    code, _, err = satvib('frf', 'run', '--folder', 'two')
    assert code == 0, err
    again = json.loads((tmp_path / 'two/frf.json').read_text())
    assert again['curves'][:12] == found['curves'][:12]


def test_a_file_of_columns(satvib, tmp_path):
    """Truth: a gain of 0.5 and noise of a tenth of the output; a median coherence of 0.99, within 0.01."""
    rng = np.random.default_rng(1)
    x = rng.normal(size=8000)
    y = 0.5 * x + 0.05 * rng.normal(size=8000)
    rows = [f'{k * 0.005:.3f},{a:.6f},{b:.6f}' for k, (a, b) in enumerate(zip(x, y, strict=True))]
    (tmp_path / 'log.csv').write_text('time [s],base,payload\n' + '\n'.join(rows) + '\n')
    code, out, err = satvib(
        'frf', 'log.csv', '--input', 'base', '--output', 'payload', '--low', '5', '--high', '90'
    )
    assert code == 0, err
    found = json.loads((tmp_path / 'runs/log-frf-001/frf.json').read_text())['curves'][0]
    assert found['coherence'] == pytest.approx(0.99, abs=0.01)
    assert found['merit']['peak'] == pytest.approx(20 * np.log10(0.5), abs=1.0)
    assert found['lowest'] >= 5.0
    assert 'payload' in out
    assert set(found['unknown']) == {'deviation'}
    assert '– (from exact; payload): the rig is not known' in out


@pytest.mark.parametrize(
    ('arguments', 'said'),
    [
        (('soft_3dof', '--estimator', 'H3'), "estimator: 'H3' is not one of H1, H2, Hv"),
        (
            ('soft_3dof', '--excite', 'payload'),
            "--excite: 'payload' is not one of base, coils, both",
        ),
        (('soft_3dof', '--signal', 'noise'), "signal: 'noise' is not one of"),
        (('soft_3dof', '--signal', 'stepped'), 'a coil is driven by'),
        (('soft_3dof', '--duration', '2'), 'fewer than three periods'),
        (('soft_3dof', '--resolution', '1', '--averages', '4'), 'give one of them'),
        (('soft_3dof', '--resolution', '1', '--averages', '4'), '--resolution, --averages: each'),
        (('soft_3dof', '--low', '50', '--high', '20'), '--high: 20 Hz is not above --low, 50 Hz'),
        (('log.csv', '--low', '50', '--high', '20'), '--high: 20 Hz is not above --low, 50 Hz'),
        (('soft_3dof', '--coil-level', '-1'), '--coil-level: -1.0 is not above 0.0 V'),
        (('soft_3dof', '--period', '-1'), '--period: -1.0 is not above 0 s'),
        (('soft_3dof', '--high', '150', '--duration', '30'), 'half the sample rate, 100 Hz'),
        (('nowhere',), "'nowhere': no such file, folder or scenario; known: clean_1dof_10hz"),
        (('soft_3dofs',), 'did you mean soft_3dof?'),
        (('soft_4dof',), 'did you mean soft_3dof?'),
        (('soft_4dof',), './satvib scenarios describes them'),
        (('no/where',), 'no/where: no such file or folder'),
        (('nowhere.csv',), 'nowhere.csv'),
        (('page.csv', '--input', 'a', '--output', 'b'), 'page.csv: is a PDF document'),
        (('page.csv',), 'page.csv: is a PDF document'),
        (('report',), 'report: holds a report, no recording'),
    ],
)
def test_what_is_wrong_is_one_line(satvib, tmp_path, arguments, said):
    """Truth: the sentence, exit code 2."""
    (tmp_path / 'page.csv').write_bytes(b'%PDF-1.7\na,b\n1,2\n')
    (tmp_path / 'report').mkdir()
    (tmp_path / 'report/result.json').write_text('{}')
    code, _, err = satvib('frf', *arguments)
    assert code == 2
    assert err.count('\n') == 1
    assert said in err


@pytest.mark.parametrize(
    ('base', 'options', 'said'),
    [
        ('noise', ('--low', '2', '--high', '500'), '--high: 500 Hz is above half the sample rate'),
        ('noise', ('--low', '500'), '--low: 500 Hz is above half the sample rate, 200 Hz'),
        ('zero', (), 'base is 0 throughout'),
        ('constant', (), 'base is 9.81 throughout'),
        ('tone', (), 'base moves at 9 Hz only: no curve; excite it broadband'),
    ],
)
def test_a_file_that_tells_nothing_is_one_line(satvib, tmp_path, base, options, said):
    """Truth: the columns, 10 s at 400 Hz; the tone lies on a line of segments of 1 s."""
    t = np.arange(4000) / 400.0
    noise, own = np.random.default_rng(1).normal(size=(2, t.size))
    kinds = {'noise': noise, 'zero': 0.0 * t, 'constant': 0.0 * t + 9.81,
             'tone': np.sin(2 * np.pi * 9.0 * t) + 1e-2 * noise}  # fmt: skip
    rows = np.column_stack([t, kinds[base], np.roll(np.sin(2 * np.pi * 9.0 * t) + own, 3)])
    np.savetxt(tmp_path / 'log.csv', rows, '%.9g', ',', header='time,base,payload', comments='')
    columns = ('--input', 'base', '--output', 'payload', '--resolution', '1')
    code, _, err = satvib('frf', 'log.csv', *columns, *options)
    assert (code, err.count('\n')) == (2, 1)
    assert said in err


def test_times_in_ms_are_warned_of_in_the_first_line(satvib, tmp_path, monkeypatch):
    """Truth: 2.5 ms, written as 2.5; frequencies with three digits that count, of a peak below 0.2 Hz."""
    monkeypatch.setattr(figures, 'draw_figures', lambda *_: ())
    noise = np.random.default_rng(1).normal(size=2000)
    late = np.convolve(noise, [0.2, 0.5, 0.3])[:2000]
    rows = np.column_stack([2.5 * np.arange(2000), noise, late])
    np.savetxt(tmp_path / 'log.csv', rows, '%.9g', ',', header='time,base,payload', comments='')
    code, out, err = satvib('frf', 'log.csv', '--input', 'base', '--output', 'payload')
    assert code == 0, err
    first = ' '.join(out.split('\n')[:2]).replace('  ', ' ')
    assert first.startswith('WARNING: a sample period of 2.5 s is long for accelerations')
    assert '--sample-period 0.0025' in first
    found = json.loads((tmp_path / 'runs/log-frf-001/frf.json').read_text())
    assert f'{found["curves"][0]["merit"]["peak_frequency"]:#.3g}' in out
