# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the launch files start, as plain data: no launch is needed. Truth: the graph of the scenario."""

import json
from collections import Counter

import pytest
from satvib_bringup.live.graph import graph_of
from satvib_bringup.live.launching.plans import PLANS
from satvib_bringup.live.process import Stage
from satvib_common.errors import SatvibError
from satvib_experiment.scenario.scenario import load_scenario


def members(name, **given):
    """Members of a plan, the other arguments at their defaults."""
    plan = PLANS[name]
    values = {key: default or '' for key, (default, _) in plan.arguments.items()} | given
    return plan.placed_members(values)


def parameters(member):
    """The `-p` of a member, read back; a later one wins."""
    texts = [
        b for a, b in zip(member.ros_arguments, member.ros_arguments[1:], strict=False) if a == '-p'
    ]
    return {text.partition(':=')[0]: json.loads(text.partition(':=')[2]) for text in texts}


def test_the_simulation_is_the_graph_of_the_scenario(tmp_path):
    """Every parameter of every node, the bag among them; only the report beside the bag is left out."""
    bag = tmp_path / 'bag'
    found = members('simulation', scenario='quick_3dof', overrides='seed=7', bag=str(bag))
    graph = graph_of(load_scenario('quick_3dof', ['seed=7']), bag=bag)
    expected = {process.full_name: process for process in graph.processes}
    assert {m.full_name for m in found} == {*expected, 'schedule'}
    for member in found:
        if member.full_name == 'schedule':
            assert parameters(member)['overrides'] == ['seed=7']
            continue
        (node,) = expected[member.full_name].nodes
        wanted = dict(node.parameters) | ({'report': ''} if node.executable == 'recorder' else {})
        assert parameters(member) == json.loads(json.dumps(wanted))
    assert [m.full_name for m in found if m.ends] == ['plant_sim']
    assert Counter(m.stage for m in found)[Stage.RECORDER] == 1


def test_a_namespace_stands_above_all():
    found = members('simulation', namespace='/rig_a/', composition='strut')
    assert {m.full_name for m in found} == {
        'rig_a/strut_1/strut', 'rig_a/strut_2/strut', 'rig_a/strut_3/strut', 'rig_a/plant_sim', 'rig_a/schedule',
    }  # fmt: skip
    (one,) = [m for m in found if m.full_name == 'rig_a/strut_2/strut']
    assert parameters(one)['strut_controller:strut'] == 1
    assert parameters(one)['strut_identifier:poles'] == 2


def test_hardware_has_the_bridge_in_the_place_of_the_plant(tmp_path):
    """Truth: the rate of the rig. Everything is in real time."""
    (tmp_path / 'c.yaml').write_text('')
    found = {m.full_name: m for m in members('hardware', channels=str(tmp_path / 'c.yaml'))}
    assert 'plant_sim' not in found
    assert parameters(found['daq_bridge']) == {
        'channels': str(tmp_path / 'c.yaml'),
        'sample_rate': 100.0,
    }
    assert found['daq_bridge'].ends
    assert parameters(found['strut_1/strut_controller'])['lockstep'] is False
    assert parameters(found['schedule'])['channels'] == str(tmp_path / 'c.yaml')


def test_one_strut_is_one_process_or_two():
    assert [m.full_name for m in members('strut', strut='strut_2')] == ['strut_2/strut']
    names = [m.full_name for m in members('strut', strut='strut_2', composition='separate')]
    assert names == ['strut_2/strut_controller', 'strut_2/strut_identifier']
    assert not any(m.ends for m in members('strut'))


@pytest.mark.parametrize(
    ('name', 'given', 'told'),
    [
        ('simulation', {'scenario': 'no'}, 'no'),
        ('simulation', {'realtime': 'yes'}, 'realtime'),
        ('simulation', {'namespace': 'rig a'}, 'namespace'),
        ('simulation', {'params_file': 'none.yaml'}, 'params_file: none.yaml'),
        ('simulation', {'composition': 'single', 'namespace': 'a'}, 'composition single'),
        ('strut', {'params_file': __file__}, 'composition:=separate'),
        ('centralized', {'scenario': 'paper_3dof'}, 'scheme'),
        ('hardware', {'channels': 'none.yaml'}, 'channels: none.yaml'),
        ('strut', {'strut': 'strut_9'}, 'strut_9'),
        ('replay', {'file': 'a.csv', 'poles': 'two'}, 'poles'),
    ],
)
def test_what_does_not_fit_is_one_line(name, given, told):
    with pytest.raises(SatvibError) as caught:
        members(name, **given)
    assert told in str(caught.value)
    assert '\n' not in str(caught.value)
