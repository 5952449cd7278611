# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The SROS2 policy of a graph. Truth: what the nodes of that graph publish, hear, offer and call, as ROS says it."""

import os
import subprocess
import sys
from collections import defaultdict
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from satvib_bringup.live.graph import graph_of, with_bridge
from satvib_bringup.live.security.enclaves import enclave_arguments
from satvib_bringup.live.security.policy import Rights, policy_of, rights_of
from satvib_experiment.scenario.scenario import load_scenario

pytestmark = pytest.mark.usefixtures('domain')
# all phases, in less time
BRIEF = [
    'duration=6.0', 'phases.2.start=2.0', 'phases.3.start=3.0', 'disturbance.start=2.0', 'analysis={}',
]  # fmt: skip
# what a node hears now and then only: the runner until the run begins, an identifier while it learns
SOMETIMES = {
    'subscribes': {'diagnostics', 'controller_state', 'voltage', 'acceleration', 'identified_model'}
}


def seen(node, name, namespace):
    """What a node does now."""
    asked = {
        'publishes': node.get_publisher_names_and_types_by_node,
        'subscribes': node.get_subscriber_names_and_types_by_node,
        'replies': node.get_service_names_and_types_by_node,
        'requests': node.get_client_names_and_types_by_node,
    }
    return {kind: {topic for topic, _ in ask(name, namespace)} for kind, ask in asked.items()}


@pytest.mark.parametrize(
    ('composition', 'more'),
    [('separate', []), pytest.param('strut', ['supervisor=true'], marks=pytest.mark.long)],
)
def test_the_policy_is_what_the_nodes_do(tmp_path, probe, composition, more):
    """Nothing is missing, and no right in the loop is unused, but those of `SOMETIMES`."""
    from satvib_bringup.live.run import run_experiment

    scenario = load_scenario('paper_1dof_10hz', [*BRIEF, *more])
    found = defaultdict(lambda: defaultdict(set))

    def look(progress):
        if progress.sequence > 100:
            for name, namespace in probe.node.get_node_names_and_namespaces():
                if name != 'probe':
                    for kind, names in seen(probe.node, name, namespace).items():
                        found[namespace, name][kind] |= names

    outcome = run_experiment(scenario, tmp_path / 'run', progress=look, composition=composition)
    assert outcome.success, outcome.message
    graph = graph_of(scenario, False, tmp_path / 'bag', composition)
    assert len(found) == len(graph.nodes) + 1
    rights = rights_of(graph)
    assert set(found) <= {(r.namespace, r.name) for nodes in rights.values() for r in nodes}
    for process, nodes in rights.items():
        there = [right for right in nodes if (right.namespace, right.name) in found]
        for kind in ('publishes', 'subscribes', 'replies', 'requests'):
            for right in there:
                extra = found[right.namespace, right.name][kind] - getattr(right, kind)
                assert extra == set(), f'{process} {right.name} {kind}'
            # nodes of one process hear a topic by one subscription; keys are those of the process
            done = set().union(*(found[right.namespace, right.name][kind] for right in there))
            allowed = frozenset().union(*(getattr(right, kind) for right in there))
            rare = SOMETIMES.get(kind, set())
            unused = {n for n in allowed - done if n.rpartition('/')[2] not in rare}
            assert unused == set(), f'{process} {kind}'


@pytest.fixture
def graph(tmp_path):
    return graph_of(load_scenario('paper_3dof'), True, tmp_path / 'bag')


def test_a_strut_gives_no_voltage_to_another(graph, tmp_path):
    """Truth: decentralized control. Nobody but the controller of a strut publishes its voltage, tools included."""
    for case in (graph, with_bridge(graph, str(tmp_path / 'channels.yaml'))):
        for process, nodes in rights_of(case).items():
            voltages = {t for r in nodes for t in r.publishes if t.endswith('/voltage')}
            strut = process.partition('/')[0]
            own = {f'/{strut}/voltage'} if process.endswith('strut_controller') else set()
            assert voltages == own, process
            assert not any('*' in t for r in nodes for t in r.publishes)


def test_the_file_says_the_rights(graph):
    """Truth: the rights, read back from the form of SROS2's policies."""
    root = ElementTree.fromstring(policy_of(graph))
    assert (root.tag, root.attrib) == ('policy', {'version': '0.2.0'})
    lists = {
        ('topics', 'publish'): 'publishes', ('topics', 'subscribe'): 'subscribes',
        ('services', 'reply'): 'replies', ('services', 'request'): 'requests',
    }  # fmt: skip
    found = {}
    for enclave in root.find('enclaves'):
        nodes = []
        for profile in enclave.find('profiles'):
            node = Rights(profile.get('ns'), profile.get('node'))
            for group in profile:
                ((right, verdict),) = group.attrib.items()
                assert verdict == 'ALLOW'
                names = frozenset(item.text for item in group)
                node = replace(node, **{lists[group.tag, right]: names})
            nodes.append(node)
        found[enclave.get('path').removeprefix('/')] = nodes
    assert found == rights_of(graph)


def test_processes_get_their_enclaves_only_with_sros2(monkeypatch):
    for name in ('ROS_SECURITY_ENABLE', 'ROS_SECURITY_ENCLAVE_OVERRIDE'):
        monkeypatch.delenv(name, raising=False)
    assert enclave_arguments('strut_1/strut_controller') == []
    monkeypatch.setenv('ROS_SECURITY_ENABLE', 'true')
    assert enclave_arguments('plant_sim') == ['--enclave', '/plant_sim']
    monkeypatch.setenv('ROS_SECURITY_ENCLAVE_OVERRIDE', '/mine')
    assert enclave_arguments('plant_sim') == []


@pytest.mark.parametrize(
    'words',
    [
        ('run', 'quick_3dof'),
        ('topics',),
        ('call', '/strut_1/strut_controller/reset'),
        ('watch', '--port', '0'),
    ],
)
def test_a_process_without_its_key_is_refused_in_one_line(tmp_path, words):
    """Truth: ROS, with `Enforce`: no key, no node. Not one word of a traceback, and exit code 2."""
    environment = os.environ | {
        'ROS_SECURITY_ENABLE': 'true', 'ROS_SECURITY_STRATEGY': 'Enforce',
        'ROS_SECURITY_KEYSTORE': str(tmp_path),
    }  # fmt: skip
    done = subprocess.run(
        [sys.executable, '-m', 'satvib_bringup.cli.main', *words], env=environment, cwd=tmp_path,
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert done.returncode == 2, done.stderr
    lines = [line for line in done.stderr.splitlines() if line.startswith('satvib: ')]
    assert len(lines) == 1, done.stderr
    assert 'Traceback' not in done.stderr
    assert 'enclave' in lines[0] or 'ecurity' in lines[0]
