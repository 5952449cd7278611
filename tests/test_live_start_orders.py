# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A graph that is started by hand: its nodes in any order, in any namespace, with a recorder or without one."""

import random
import signal

import pytest

SPACES = ('/', '/rig_a', '/lab/rig_b')
SIGNALS = (signal.SIGINT, signal.SIGTERM)
# all phases, in less time
BRIEF = [
    'duration=6.0', 'phases.2.start=2.0', 'phases.3.start=3.0', 'disturbance.start=2.0', 'analysis={}',
]  # fmt: skip


def members_of(scenario, changes, bag, rng):
    """The nodes of a scenario in lockstep, with `schedule`, in a random order: package, executable, namespace, name,
    parameters."""
    from satvib_bringup.live.graph import graph_of
    from satvib_experiment.scenario.scenario import load_scenario

    graph = graph_of(load_scenario(scenario, changes), False, bag, 'separate')
    plan = {'scenario': scenario} | ({'overrides': changes} if changes else {})
    members = [('satvib_bringup', 'schedule', '/', 'schedule', plan)]
    for process in graph.processes:
        (node,) = process.nodes
        parameters = dict(node.parameters)
        if process.executable == 'plant_sim':
            parameters['lockstep_timeout'] = (
                120.0  # whoever is last comes when all others are there
            )
        members.append(
            (process.package, process.executable, process.namespace, process.name, parameters)
        )
    rng.shuffle(members)
    return graph, members


def run_in_order(start, probe, folder, scenario, seed, space, recorded, changes=()):
    """Start each node when the one before is in the graph; the plant ends by itself, the others by a signal."""
    from satvib_experiment.recording.bag_reader import read_recording

    from satvib_msgs.msg import VcaVoltage

    rng = random.Random(seed)
    bag = folder / 'bag' if recorded else None
    graph, members = members_of(scenario, list(changes), bag, rng)
    above = space.rstrip('/')
    answers = {
        strut: probe.collect(VcaVoltage, f'{above}/{strut}/voltage') for strut in graph.struts
    }
    print(f'seed {seed} in {space}: {", ".join(f"{m[2]} {m[3]}" for m in members)}')
    running = {}
    for package, executable, namespace, name, parameters in members:
        where = f'{above}{namespace}'.rstrip('/') or '/'
        running[where, name] = start(
            package, executable, where, more=('-r', f'__node:={name}'), **parameters
        )
        probe.wait(lambda own=(name, where): own in probe.node.get_node_names_and_namespaces())
    plant = running.pop((space, 'plant_sim'))
    assert plant.wait(120.0) == 0, plant.said
    end = graph.plan.end
    assert f'{end} samples of {len(graph.struts)} struts' in plant.said
    for strut, voltages in answers.items():
        probe.wait(lambda v=voltages: v and v[-1].sequence == end - 1)
        assert [v.sequence for v in voltages] == list(range(end)), strut
        assert not any(v.fault for v in voltages)
    for process in rng.sample(list(running.values()), len(running)):
        process.send(rng.choice(SIGNALS))
        assert process.wait() == 0, process.said
        assert 'Traceback' not in process.said
    if (
        bag is not None and members[-1][3] != 'recorder'
    ):  # a recorder that comes last may come after the run
        assert int(read_recording(bag).sequence[-1]) == end - 1


@pytest.mark.parametrize(('seed', 'recorded'), [(1, False), (2, True)])
def test_a_graph_of_one_strut_may_be_started_in_any_order(start, probe, tmp_path, seed, recorded):
    """Truth: the schedule. Every sample is answered once, in order, and every node ends with exit code 0."""
    run_in_order(start, probe, tmp_path, 'paper_1dof_10hz', seed, SPACES[1], recorded, BRIEF)


@pytest.mark.long
@pytest.mark.parametrize('seed', range(10, 30))
def test_a_graph_may_be_started_in_any_order_anywhere(start, probe, tmp_path, seed):
    """As the short form: three struts, twenty orders in three namespaces, every other one with a recorder."""
    space, recorded = SPACES[seed % 3], seed % 2 == 0
    run_in_order(start, probe, tmp_path, 'quick_3dof', seed, space, recorded)
