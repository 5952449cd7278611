# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Settings that cannot be run, as files. Truth: each case's page in ../shared/cases says what must happen.

What is refused is refused when the file is loaded, which is before a folder is made or a sample is computed.
"""

import shutil
from pathlib import Path

import pytest
from rich.table import Table
from satvib_bringup.cli import main
from satvib_bringup.cli.console import make_console
from satvib_common.errors import SatvibError
from satvib_experiment.recording.run_folder import free_run_folder
from satvib_experiment.scenario.folder import scenario_path
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate
from satvib_studies.campaign.settings import Campaign, load_campaign
from satvib_studies.campaign.trials import plan_trials

CASES = Path(__file__).resolve().parents[4].parent / 'shared' / 'cases'
has_cases = pytest.mark.skipif(not CASES.is_dir(), reason='the cases are not here: ../shared/cases')


@has_cases
@pytest.mark.parametrize(
    ('file', 'message'),
    [
        ('yaml_bomb_in_a_value/seed_bomb.yaml', 'line 4: more than 100000 values'),
        ('yaml_duration_too_long/huge_duration.yaml', r'duration: 1e\+14 samples need .* GB'),
        ('yaml_duration_too_long/huge_duration308.yaml', 'duration: .* too many samples'),
        ('yaml_name_not_for_a_folder/name_esc.yaml', 'cannot be part of a folder name'),
        ('yaml_name_not_for_a_folder/name_nul.yaml', 'cannot be part of a folder name'),
        ('yaml_name_not_for_a_folder/name_surrogate.yaml', 'cannot be part of a folder name'),
        ('disturbance_beyond_the_grid/disturbance_4010.yaml', 'frequency: 4010.0 Hz .*2000.0 Hz'),
        ('yaml_template_not_filled/jinja.yaml', 'line 5: a key is expected.*template'),
    ],
)
def test_a_scenario_that_cannot_be_run(file, message):
    with pytest.raises(SatvibError, match=message) as caught:
        load_scenario(CASES / file)
    assert str(caught.value).isprintable()


@has_cases
def test_a_merge_key_is_merged():
    loaded = load_scenario(CASES / 'yaml_merge_key' / 'merge_anchor.yaml')
    assert loaded.controller == {'law': 'narrowband', 'excitation': 'prbs'}


@has_cases
@pytest.mark.parametrize(
    ('file', 'message'),
    [('lognormal_overflow.yaml', 'spread'), ('own_seed_overflow.yaml', r'seed: .*beyond 2\^63')],
)
def test_a_campaign_that_overflows(file, message):
    with pytest.raises(SatvibError, match=message):
        plan_trials(load_campaign(CASES / 'campaign_overflows' / file))


@pytest.mark.parametrize(
    ('setting', 'message'),
    [
        ('name="."', 'folder name'),
        ('name=".."', 'folder name'),
        ('name="a/b"', 'folder name'),
        ('name="\\u202Ea"', 'folder name'),
        ('duration=1' + '0' * 400, 'a number of 401 digits'),
        ('duration=.inf', 'not a finite number'),
        ('duration=9007199254740993', 'too many samples'),
        ('duration=2026-13-45', 'a date'),
        ('rig.acquisition.sample_rate=1e300', 'sample_rate'),
        ('disturbance={kind: [1]}', 'kind'),
        ('disturbance={1: 2}', 'is not text'),
        ('rig_overrides=[1]', 'rig_overrides'),
        ('disturbance.frequency=2000', 'frequency: 2000.0 Hz'),
        (
            'disturbance={kind: sweep, amplitude: 1, frequency: 1, end_frequency: 2500, duration: 1}',
            'end_frequency: 2500.0 Hz',
        ),
        ('disturbance={kind: tones, amplitudes: [1, 1], frequencies: [5, 2100]}', '2100.0 Hz'),
        (
            (
                'disturbance={kind: reaction_wheel, speed: 10, end_speed: 60, harmonics: [1, 40], '
                'coefficients: [1, 1]}'
            ),
            '2400.0 Hz',
        ),
        ('disturbance={kind: sum, terms: [{kind: sine, amplitude: 1, frequency: 3000}]}', '3000'),
        (
            (
                'failures=[{kind: disturbance_changed, time: 1, '
                'disturbance: {kind: sine, amplitude: 1, frequency: 4000}}]'
            ),
            '4000.0 Hz',
        ),
        ('seed=0x' + 'f' * 40, r'beyond 2\^63'),
    ],
)
def test_a_setting_that_cannot_be_run(setting, message):
    with pytest.raises(SatvibError, match=message) as caught:
        load_scenario(scenario_path('quick_3dof'), [setting])
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    'distribution',
    [
        {'kind': 'uniform', 'low': -1e308, 'high': 1e308},
        {'kind': 'normal', 'mean': 0.0, 'deviation': 1e308},
        {'kind': 'normal', 'mean': 1e30, 'deviation': 1.0, 'whole': True},
        {'kind': 'choice', 'values': [10**30]},
    ],
)
def test_a_distribution_that_no_number_holds(distribution):
    with pytest.raises(SatvibError, match=r'reaches|beyond 2\^63'):
        Campaign(name='a', scenario='quick_3dof', trials=2, parameters={'seed': distribution})


@pytest.mark.parametrize('name', ['', '.', '..', 'a/b', 'a\0b', '\ud800', 'a' * 300, 'a\nb'])
def test_a_name_that_is_none_for_a_folder(name, tmp_path):
    with pytest.raises(SatvibError, match='folder name'):
        free_run_folder(name, base=tmp_path)


@pytest.mark.parametrize('text', ['acc[g].csv', 'm[b].yaml', '[red]a[/red]', ':smile: [/]'])
def test_names_are_printed_as_they_are(text, capsys):
    console = make_console()
    table = Table(title=text)
    table.add_column(text)
    table.add_row(text)
    console.print(table)
    console.print(f'model: {text}')
    assert capsys.readouterr().out.count(text) == 4


def test_control_characters_are_printed_as_escapes(capsys):
    make_console().print('a\x1b[31mb')
    assert capsys.readouterr().out == 'a\\x1b[31mb\n'


@pytest.fixture(scope='module')
def recording(tmp_path_factory):
    """A run of the offline twin in a folder of its own."""
    folder = tmp_path_factory.mktemp('runs') / 'quick-001'
    folder.mkdir()
    simulate(load_scenario('quick_3dof')).save(folder / 'recording.npz')
    return folder


@pytest.mark.usefixtures('no_figures')
@pytest.mark.parametrize('path', ['.', '../quick-001/', './recording.npz'])
def test_the_folder_one_stands_in_has_a_name(recording, tmp_path, monkeypatch, capsys, path):
    """Truth: the case's page: the report is beside the folder; of a file it is beside the file."""
    folder = tmp_path / 'quick-001'
    shutil.copytree(recording, folder)
    monkeypatch.chdir(folder)
    monkeypatch.setattr('sys.argv', ['satvib', 'report', path])
    with pytest.raises(SystemExit) as ended:
        main.main()
    assert not ended.value.code
    assert 'report.html' in ''.join(capsys.readouterr().out.split())
    wanted = folder / 'recording-report' if path.endswith('.npz') else tmp_path / 'quick-001-report'
    assert (wanted / 'report.html').is_file()
