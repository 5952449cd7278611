# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Scenarios: what is wrong in one is told in one line that names the file and the key."""

from pathlib import Path

import pytest
import yaml
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_common.settings_text import change_settings
from satvib_experiment.scenario.folder import FOLDER, listed_scenarios, scenario_names
from satvib_experiment.scenario.scenario import Scenario, load_scenario


@pytest.mark.parametrize('name', scenario_names())
def test_every_scenario_of_the_package_loads_and_comes_back(name):
    """Truth: the mapping that a scenario gives makes the same scenario again."""
    scenario = load_scenario(name)
    assert scenario.name == name
    assert Scenario.from_mapping(scenario.to_mapping()) == scenario
    rate = scenario.load_rig().acquisition.sample_rate
    assert scenario.identifier_parameters(rate).sample_rate == rate
    parameters = scenario.controller_parameters(rate, strut_index=2)
    assert parameters.sample_rate == rate
    # one controller for all struts is not that of a certain one
    assert parameters.strut == (0 if scenario.scheme == 'centralized' else 2)


def test_the_list_of_scenarios_says_what_they_are():
    """Truth: each of them loaded."""
    for listed in listed_scenarios():
        scenario = load_scenario(listed.name)
        rate = scenario.load_rig().acquisition.sample_rate
        law = scenario.controller_parameters(rate).law
        assert listed == (
            scenario.name, scenario.rig, law, scenario.duration, scenario.description
        )  # fmt: skip


def test_the_paper_scenario_has_the_phases_of_the_paper():
    """Truth: the paper, 3-DOF experiment, and the project's statement of it, in samples at 100 Hz."""
    plan = load_scenario('paper_3dof').plan(100.0)
    assert plan.phases == (
        Phase.CALIBRATE,
        Phase.IDENTIFY,
        Phase.ADAPT,
        Phase.STANDBY,
        Phase.CONTROL,
    )
    assert plan.first == (0, 100, 300, 500, 1000)
    assert plan.end == 2500


def test_overrides_reach_every_depth():
    """Truth: the values given."""
    scenario = load_scenario(
        'quick_3dof',
        [
            'seed=7',
            'controller.law=velocity_feedback',
            'rig.payload.mass=12',
            'disturbance.amplitude=2e-1',
            'phases.4.start=3.5',
            'analysis.controlled=[3.6, 4.0]',
        ],
    )
    assert scenario.seed == 7
    assert scenario.controller['law'] == 'velocity_feedback'
    assert scenario.load_rig().payload.mass == 12.0
    assert scenario.disturbance['amplitude'] == 0.2
    assert scenario.phases[4].start == 3.5
    assert scenario.analysis.controlled == (3.6, 4.0)


BAD_OVERRIDES = {
    'sed=7': 'sed: no such key; did you mean seed?',
    'seed=-1': 'seed: -1 is less than 0',
    'seed=many': 'seed: a whole number is expected',
    'seed': 'key=value is expected',
    '=3': 'key=value is expected',
    'seed.x=3': '--set seed.x=3: seed has no keys below it',
    'duration=0': 'duration: 0.0 is not above 0.0 s',
    'controller.lav=off': 'lav: no such key; did you mean law?',
    'controller.law=magic': "'magic' is not one of",
    'controller.lockstep=true': 'controller.lockstep: the way of running sets it',
    'identifier.sample_rate=10': 'identifier.sample_rate: the rig sets it',
    'identifier.poles=0': 'poles: 0 is less than 1',
    'rig.payload.mass=-1': 'payload.mass: -1.0 is not above 0.0 kg',
    'rig.acquisition.sample_rate=0': 'sample_rate: 0.0 is not above 0.0 Hz',
    'rig.payload.weight=1': 'weight: no such key',
    'rig=nothing_3dof': 'no such rig',
    'rig=paper_1dof': '3 figures for the 1 struts of paper_1dof',
    'rig.struts.stiffness_scale=[1.0]': '1 factors for 3 struts',
    'disturbance.kind=earthquake': "'earthquake'",
    'disturbance.volume=3': 'volume: no such key',
    'phases.1.start=9.0': 'a phase begins at',
    'phases.1.phase=SLEEP': 'SLEEP',
    'phases=[]': 'phases: at least one is needed',
    'analysis.controlled=[20, 26]': 'ends at 26.0 s, after the 25.0 s',
    'analysis.controlled=[2]': 'a start and a later end are expected',
    'name=a/b': 'cannot be part of a folder name',
}


@pytest.mark.parametrize('override', BAD_OVERRIDES)
def test_a_wrong_setting_is_one_line_that_names_it(override):
    """Truth: the list above, written by hand; no message has a line break."""
    with pytest.raises(SatvibError) as caught:
        load_scenario('paper_3dof', [override])
    message = str(caught.value)
    assert BAD_OVERRIDES[override] in message
    assert '\n' not in message
    if '=' in override[1:] and not message.startswith('--set'):
        assert message.startswith('scenario paper_3dof: ')


def test_a_wrong_name_gets_the_nearest_one():
    """Truth: the names of the package."""
    with pytest.raises(SatvibError, match='did you mean paper_3dof'):
        load_scenario('paper_3df')
    with pytest.raises(SatvibError, match=r'nowhere\.yaml: cannot be read'):
        load_scenario('nowhere.yaml')


@pytest.mark.parametrize(
    ('text', 'told'),
    [
        ('', 'is empty'),
        ('- a\n- b\n', 'a mapping of keys is expected'),
        ('name: [', 'not YAML'),
        ('name: a\nname: b\n', 'name is given twice'),
        ('name: a\n', 'missing'),
    ],
)
def test_a_broken_file_is_named(tmp_path, text, told):
    """Truth: written by hand."""
    path = tmp_path / 'mine.yaml'
    path.write_text(text)
    with pytest.raises(SatvibError) as caught:
        load_scenario(path)
    assert told in str(caught.value)
    assert 'mine.yaml' in str(caught.value)


def test_a_rig_beside_the_scenario_is_found(tmp_path):
    """Truth: the mass written into the file."""
    rig = load_scenario('paper_3dof').load_rig().to_mapping()
    rig['payload']['mass'] = 8.25
    (tmp_path / 'my_rig.yaml').write_text(yaml.safe_dump(rig))
    text = (FOLDER / 'quick_3dof.yaml').read_text().replace('rig: paper_3dof', 'rig: my_rig.yaml')
    (tmp_path / 'mine.yaml').write_text(text)
    assert load_scenario(tmp_path / 'mine.yaml').load_rig().payload.mass == 8.25


def _rig_of_mass(path, mass):
    data = load_scenario('paper_3dof').load_rig().to_mapping()
    data['payload']['mass'] = mass
    path.write_text(yaml.safe_dump(data))


@pytest.mark.parametrize('scenario', ['quick_3dof', 'there/mine.yaml'])
def test_a_path_of_the_command_line_is_relative_to_the_current_folder(
    tmp_path, monkeypatch, scenario
):
    """Truth: two rigs and two files of gains of one name, one in the current folder, one beside the scenario."""
    beside = tmp_path / 'there'
    beside.mkdir()
    for folder, value in ((tmp_path, 7.0), (beside, 8.0)):
        _rig_of_mass(folder / 'rig.yaml', value)
        (folder / 'gains.yaml').write_text(f'centralized: {{gains_i: [{value}, 1, 1]}}\n')
    (beside / 'mine.yaml').write_text((FOLDER / 'quick_3dof.yaml').read_text())
    monkeypatch.chdir(tmp_path)
    for gains in ('centralized.file=gains.yaml', 'centralized={file: gains.yaml}'):
        loaded = load_scenario(scenario, ['rig=rig.yaml', 'scheme=centralized', gains])
        assert loaded.load_rig().payload.mass == 7.0
        assert loaded.centralized['gains_i'] == [7.0, 1, 1]
        monkeypatch.chdir('/')  # what is loaded no longer depends on the folder
        assert loaded.load_rig().payload.mass == 7.0
        monkeypatch.chdir(tmp_path)
    with pytest.raises(SatvibError, match=f'{tmp_path}/other.yaml: cannot be read'):
        load_scenario(scenario, ['rig=other.yaml'])


def test_what_is_wrong_in_the_file_of_a_rig_leads_with_that_file(tmp_path, monkeypatch):
    """Truth: the file that a person has to mend, under a scenario of the package and under one of their own."""
    monkeypatch.chdir(tmp_path)
    rig = load_scenario('paper_3dof').load_rig().to_mapping()
    rig['payload']['mass'] = -1.0
    Path('rig.yaml').write_text(yaml.safe_dump(rig))
    Path('mine.yaml').write_text((FOLDER / 'quick_3dof.yaml').read_text())
    for scenario in ('paper_3dof', 'mine.yaml'):
        for name, told in (
            ('rig', 'payload.mass: -1.0'),
            ('other', 'cannot be read: No such file'),
        ):
            with pytest.raises(SatvibError) as caught:
                load_scenario(scenario, [f'rig={name}.yaml'])
            assert str(caught.value).startswith(f'{tmp_path}/{name}.yaml: {told}')
            assert str(caught.value).count(f'{name}.yaml') == 1


def test_overrides_do_not_touch_each_other():
    """Truth: by hand."""
    data = {'rig_overrides': {'payload.mass': 1}}
    change_settings(data, ['rig.coil.resistance=3', 'controller.law=off'])
    assert data == {
        'rig_overrides': {'payload.mass': 1, 'coil.resistance': 3},
        'controller': {'law': 'off'},
    }


def test_the_scenario_of_the_documentation_loads(tmp_path):
    """Truth: the page says that it does; the values are those on the page."""
    page = Path(__file__).resolve().parents[4] / 'docs' / 'scenarios.md'
    text = page.read_text(encoding='utf-8').split('```yaml\n')[1].split('```')[0]
    (tmp_path / 'mine.yaml').write_text(text)
    scenario = load_scenario(tmp_path / 'mine.yaml')
    assert scenario.load_rig().payload.mass == 10.5
    assert scenario.analysis.reference == (-23.35, -26.0, -29.28)
    rate = scenario.load_rig().acquisition.sample_rate
    assert scenario.controller_parameters(rate).law == 'narrowband'
