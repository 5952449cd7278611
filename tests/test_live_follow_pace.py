# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Nodes that meet agree on lockstep or real time: the source of the samples says it, whatever their parameters are."""

import signal

CONTROLLER = ('satvib_control', 'strut_controller')
IDENTIFIER = ('satvib_ident', 'strut_identifier')
PLANT = ('satvib_plant_sim', 'plant_sim')
RATE = 200.0
END = 800
SHAKE = '{kind: sine, frequency: 10.0, amplitude: 1.0}'


def schedule(end):
    from satvib_msgs.msg import Schedule

    return Schedule(
        scenario='test', seed=1, sample_period=1.0 / RATE, struts=['strut_1'],
        phases=[0, 1, 2, 4], first_sequence=[0, 50, 150, 600], end_sequence=end,
    )  # fmt: skip


def answers(start, probe, end, plant, late=False, **loop):
    """Voltages by sample of a graph of one strut, and what its nodes said; `late`: the plant is there first."""
    from satvib_msgs.msg import Schedule, StrutAcceleration, VcaVoltage

    loop = {'sample_rate': RATE, 'law': 'velocity_feedback', 'struts': 1, **loop}
    own = {k: v for k, v in loop.items() if k in {'sample_rate', 'lockstep'}}
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    samples = probe.collect(StrutAcceleration, '/strut_1/acceleration')
    plan = probe.publisher(Schedule, '/schedule')
    setting = {'rig': 'paper_1dof', 'disturbance': SHAKE, 'lockstep_timeout': 60.0, **plant}
    clock = start(*PLANT, **setting)
    if late:
        plan.publish(schedule(end))
        probe.wait(lambda: samples)
    others = [start(*IDENTIFIER, '/strut_1', **own), start(*CONTROLLER, '/strut_1', **loop)]
    if not late:
        probe.wait(lambda: plan.get_subscription_count() == 3)
        plan.publish(schedule(end))
    assert clock.wait() == 0, clock.said
    probe.wait(lambda: voltages and voltages[-1].sequence == end - 1)
    for node in others:
        node.send(signal.SIGINT)
        assert node.wait() == 0, node.said
    probe.node.destroy_publisher(plan)
    return {v.sequence: v.voltage for v in voltages}, [node.said for node in others]


def test_nodes_with_their_defaults_follow_lockstep(start, probe):
    """Truth: the twin's rule, that lockstep has the same bits every time: a graph whose nodes are all told to.

    The default of a controller and of an identifier is real time, that of the plant is lockstep. With `late` the first
    sample is published before they are there, and no other comes before it is answered.
    """
    told, quiet = answers(start, probe, END, {}, lockstep=True)
    assert sorted(told) == list(range(END))
    assert max(abs(v) for v in told.values()) > 1.0
    assert not any('the samples come' in text for text in quiet)
    for late in (False, True):
        found, said = answers(start, probe, END, {}, late)
        assert found == told, late
        assert all(text.count('the samples come in lockstep') == 1 for text in said), late


def test_nodes_that_are_told_lockstep_follow_the_clock(start, probe):
    """Truth: the schedule. No controller waits for the model of a hand-over, and the run ends by the clock."""
    found, said = answers(start, probe, END, {'lockstep': False}, lockstep=True)
    assert max(abs(v) for v in found.values()) > 1.0
    assert max(found) == END - 1
    assert all(text.count('the samples come by the clock') == 1 for text in said)
