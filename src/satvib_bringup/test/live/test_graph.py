# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The description of the live graph."""

from pathlib import Path

import pytest
from satvib_bringup.live.graph import graph_of
from satvib_bringup.live.process import Stage
from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import parse_yaml
from satvib_control.parameters import ControllerParameters
from satvib_experiment.scenario.scenario import load_scenario
from satvib_ident.parameters import IdentifierParameters
from satvib_plant_sim.nodes.parameters import PlantParameters

SCHEMAS = {
    'plant_sim': PlantParameters,
    'strut_controller': ControllerParameters,
    'strut_identifier': IdentifierParameters,
}


@pytest.fixture(scope='module')
def graph():
    return graph_of(load_scenario('quick_3dof', ['rig.payload.mass=9.5']), bag=Path('/x/bag'))


def test_one_process_per_part(graph):
    """Truth: docs/architecture.md: one plant, per strut a controller and an identifier, a recorder."""
    struts = ('strut_1', 'strut_2', 'strut_3')
    expected = {'plant_sim', 'recorder'}
    expected |= {f'{s}/{n}' for s in struts for n in ('strut_controller', 'strut_identifier')}
    assert {p.full_name for p in graph.processes} == expected
    assert graph.struts == struts
    assert graph.processes[-1].stage == Stage.SOURCE


def test_parameter_files_give_back_the_parameters(graph):
    """Truth: the schemas; what the file says is what the node will hold."""
    for process in graph.processes:
        values = parse_yaml(process.parameter_file(), 'x')['/**']['ros__parameters']
        assert [values] == [dict(node.parameters) for node in process.nodes]
        if process.executable in SCHEMAS:
            schema = SCHEMAS[process.executable]
            assert schema.from_mapping(values).to_mapping() == values


def test_the_struts_differ_in_nothing_but_their_index(graph):
    """Truth: decentralized control: the same parameters, another strut."""
    controllers = [p.parameters for p in graph.nodes if p.executable == 'strut_controller']
    assert [p['strut'] for p in controllers] == [0, 1, 2]
    assert len({tuple(str(p | {'strut': 0})) for p in controllers}) == 1


def test_the_plant_gets_the_rig_of_the_scenario(graph):
    """Truth: the scenario's own rig."""
    values = next(p.parameters for p in graph.nodes if p.executable == 'plant_sim')
    plant = PlantParameters.from_mapping(dict(values))
    assert plant.load_rig() == load_scenario('quick_3dof', ['rig.payload.mass=9.5']).load_rig()


def test_who_reads_what(graph):
    """Truth: the table of topics in the design, and the recorder, which reads all."""
    readers = graph.readers()
    assert readers['/schedule'] == 8
    assert readers['/strut_2/acceleration'] == 3
    assert readers['/strut_2/voltage'] == 3
    assert readers['/strut_2/identified_model'] == 2
    assert readers['/strut_2/truth'] == 1
    unrecorded = graph_of(load_scenario('quick_3dof')).readers()
    assert unrecorded['/strut_2/truth'] == 0


def test_a_supervisor_reads_accelerations_and_voltages():
    """Truth: one reader more of each; in lockstep the controllers read its judgement, in real time nobody does."""
    scenario = load_scenario('quick_3dof', ['supervisor=true'])
    graph = graph_of(scenario)
    readers, without = graph.readers(), graph_of(load_scenario('quick_3dof')).readers()
    for topic in ('/schedule', '/strut_2/acceleration', '/strut_2/voltage'):
        assert readers[topic] == without[topic] + 1
    assert readers['/supervision'] == 3
    assert '/supervision' not in graph_of(scenario, realtime=True).readers()
    controllers = [node for node in graph.nodes if node.executable == 'strut_controller']
    assert all(node.parameters['supervised'] for node in controllers)
    with pytest.raises(SatvibError, match='hears all struts itself'):
        load_scenario('soft_3dof_centralized', ['supervisor=true'])


def test_a_kill_needs_real_time_and_names_its_process():
    """In lockstep the plant would wait for ever; in real time the graph names what is killed at which sample."""
    kill, kill_all = (
        f'failures=[{{kind: controller_killed, {which}time: 2.0}}]' for which in ('strut: 2, ', '')
    )
    scenario = load_scenario('soft_3dof', [kill])
    with pytest.raises(SatvibError, match='run it with --realtime, or simulate it'):
        graph_of(scenario)
    graph = graph_of(scenario, realtime=True)
    assert graph.kills == ((400, 'strut_2/strut_controller'),)
    assert graph.silenced() == {'strut_2'}
    central = graph_of(load_scenario('soft_3dof_centralized', [kill_all]), realtime=True)
    assert central.kills == ((400, 'centralized_controller'),)
    assert central.silenced() == {'strut_1', 'strut_2', 'strut_3'}
    plant = next(p for p in graph.nodes if p.name == 'plant_sim')
    assert plant.parameters['failures'] == '[]'


def test_a_process_for_each_strut():
    """Truth: the composition's table. A strut's process holds its own two nodes and reads nothing of other struts."""
    graph = graph_of(load_scenario('quick_3dof'), bag=Path('/x/bag'), composition='strut')
    struts = ('strut_1', 'strut_2', 'strut_3')
    assert {p.full_name for p in graph.processes} == {
        'plant_sim', 'recorder', *(f'{s}/strut' for s in struts)
    }  # fmt: skip
    for process in graph.processes:
        if process.executable != 'strut':
            continue
        strut = process.namespace.strip('/')
        names = [node.name for node in process.nodes]
        assert names == ['strut_controller', 'strut_identifier']
        topics = {topic for node in process.nodes for topic in node.reads | node.writes}
        assert {topic.split('/')[1] for topic in topics} == {strut, 'schedule'}
        sections = parse_yaml(process.parameter_file(), 'x')
        assert sections == {
            f'/{node.full_name}': {'ros__parameters': dict(node.parameters)}
            for node in process.nodes
        }
    readers = graph.readers()
    assert readers['/schedule'] == 5
    assert readers['/strut_2/acceleration'] == 2
    assert readers['/strut_2/identified_model'] == 1
    same = graph_of(load_scenario('quick_3dof'), bag=Path('/x/bag')).nodes
    assert graph.nodes == same


def test_single_has_no_process_and_cannot_lose_one():
    """Truth: all nodes are in the runner's process; a controller that is to be killed has none of its own."""
    graph = graph_of(load_scenario('quick_3dof'), composition='single')
    assert graph.processes == ()
    assert len(graph.nodes) == 7
    kill = 'failures=[{kind: controller_killed, time: 2.0}]'
    with pytest.raises(SatvibError, match='composition single'):
        graph_of(load_scenario('soft_3dof', [kill]), realtime=True, composition='single')
    with pytest.raises(SatvibError, match="'pairs' is not one of separate, strut, single"):
        graph_of(load_scenario('quick_3dof'), composition='pairs')
    strut = graph_of(load_scenario('soft_3dof', [kill]), realtime=True, composition='strut')
    assert strut.kills[0] == (400, 'strut_1/strut')
    assert strut.silenced() == {'strut_1', 'strut_2', 'strut_3'}


def test_how_many_messages_a_strut_publishes():
    """Truth: the plan of quick_3dof, 400 samples at 100 Hz with 100 of IDENTIFY; blocks of truth of 0.05 s."""
    scenario = load_scenario('quick_3dof')
    identify = sum(scenario.plan(100.0).at(k).name == 'IDENTIFY' for k in range(400))
    assert graph_of(scenario).expected == (400, identify, 400, 80)
    assert graph_of(scenario, realtime=True).expected == (400, identify, 80, 80)
