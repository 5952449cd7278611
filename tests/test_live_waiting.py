# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A node that waits says for what, in its log and on /diagnostics, and where there is what it does not find."""

import signal

NOBODY = 'on which no node publishes'
# executable: package, namespace, parameters, what it waits for; every node is in a namespace of its own
NODES = {
    'plant_sim': ('satvib_plant_sim', '/a', {}, f'the schedule on /a/schedule, {NOBODY}'),
    'strut_controller': (
        'satvib_control', '/b/strut_1', {},
        f'samples on /b/strut_1/acceleration, {NOBODY}; there is /a/strut_1/acceleration',
    ),
    'strut_identifier': (
        'satvib_ident', '/c/strut_1', {},
        f'samples on /c/strut_1/acceleration, {NOBODY}; there is /a/strut_1/acceleration',
    ),
    'supervisor': ('satvib_control', '/d', {}, f'the schedule on /d/schedule, {NOBODY}'),
    'recorder': (
        'satvib_bringup', '/e', {},
        f'the schedule, for the names of the struts, on /e/schedule, {NOBODY}',
    ),
    'schedule': (
        'satvib_bringup', '/f', {'scenario': 'paper_1dof_10hz', 'realtime': True},
        'strut_1/strut_controller, before the schedule is published',
    ),
    'centralized_controller': (
        'satvib_control', '/h', {}, f'samples on /h/strut_1/acceleration, {NOBODY}; there is',
    ),
}  # fmt: skip


def test_a_node_that_waits_says_for_what(start, probe):
    """Truth: what was started, and in which namespaces. The log says it, too, and no node says that all is well."""
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

    arrays = probe.collect(DiagnosticArray, '/diagnostics', whole=False)
    nodes = {
        name: start(package, name, space, **parameters)
        for name, (package, space, parameters, _) in NODES.items()
    }

    def newest(name):
        full = f'{NODES[name][1]}/{name}'
        found = [s for a in arrays for s in a.status if s.name == full]
        return found[-1] if found else DiagnosticStatus()

    for name, (*_, what) in NODES.items():
        waits = f'waits for {what}'
        probe.wait(lambda n=name, w=waits: newest(n).message.startswith(w))
        assert newest(name).level == DiagnosticStatus.WARN
        probe.wait(lambda n=name, w=waits: w in nodes[n].said)
    well = {s.name for a in arrays for s in a.status if s.message == 'all is well'}
    assert not well
    for node in nodes.values():
        node.send(signal.SIGINT)
        assert node.wait() == 0, node.said


def test_a_controller_alone_without_a_namespace_says_so(start, probe):
    """Truth: what was started: no node publishes what it listens to, in whatever namespace."""
    controller = start('satvib_control', 'strut_controller')
    what = f'waits for samples on /acceleration, {NOBODY}; is the namespace right? ('
    probe.wait(lambda: what in controller.said)


def test_who_has_waited_and_gets_it_waits_no_more(start, probe):
    """Truth: the messages that are published. The controller waits for samples, then for the schedule, then not."""
    from diagnostic_msgs.msg import DiagnosticArray

    from satvib_msgs.msg import Schedule, StrutAcceleration

    arrays = probe.collect(DiagnosticArray, '/diagnostics', whole=False)
    samples = probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    plan = probe.publisher(Schedule, '/schedule')
    start('satvib_control', 'strut_controller', '/strut_1', law='off')

    def says(text):
        return lambda: arrays and arrays[-1].status[0].message.startswith(text)

    probe.wait(says('waits for samples on /strut_1/acceleration'))
    sample = StrutAcceleration(sequence=1, sample_period=0.01)
    probe.wait(lambda: samples.get_subscription_count() == 1)
    samples.publish(sample)
    probe.wait(says('waits for the schedule on /schedule; until then STANDBY, 0 V'))
    plan.publish(Schedule(sample_period=0.01, struts=['strut_1'], phases=[0], first_sequence=[0]))
    probe.wait(says('waits for samples on /strut_1/acceleration, after 1'))

    def well():
        sample.sequence += 1
        samples.publish(sample)
        return says('all is well')()

    probe.wait(well)


def test_a_real_time_graph_in_a_namespace_begins_at_once(start, probe):
    """Truth: what the schedule node says when it has waited in vain, which it does not; and the first samples."""
    from satvib_bringup.live.graph import graph_of
    from satvib_experiment.scenario.scenario import load_scenario

    from satvib_msgs.msg import VcaVoltage

    graph = graph_of(load_scenario('paper_1dof_10hz'), realtime=True)
    voltages = probe.collect(VcaVoltage, '/rig_a/strut_1/voltage')
    schedule = start(
        'satvib_bringup', 'schedule', '/rig_a', scenario='paper_1dof_10hz', realtime=True
    )
    for process in graph.processes:
        start(
            process.package,
            process.executable,
            f'/rig_a{process.namespace}'.rstrip('/'),
            more=('-r', f'__node:={process.name}'),
            **process.nodes[0].parameters,
        )
    probe.wait(lambda: len(voltages) >= 100)
    assert [voltage.sequence for voltage in voltages[:100]] == list(range(100))
    assert 'begins although' not in schedule.said
