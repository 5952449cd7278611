# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Two controllers, plants, identifiers or schedules where there is one: 0 V or refused, and both are named."""

import re

import pytest

PLANT = ('satvib_plant_sim', 'plant_sim')
CONTROLLER = ('satvib_control', 'strut_controller')
IDENTIFIER = ('satvib_ident', 'strut_identifier')
RATE = 200.0
SHAKE = '{kind: sine, frequency: 10.0, amplitude: 1.0}'
LAW = {'sample_rate': RATE, 'law': 'velocity_feedback', 'struts': 1, 'control_at_start': True}
RIG = {'rig': 'paper_1dof', 'disturbance': SHAKE, 'wait_for_schedule': False}
SECOND = ('-r', '__node:=second')


def named(*names):
    """The names of the nodes as they are said."""
    return ', '.join(f'/{name}' for name in names)


@pytest.fixture
def reports(probe):
    """A function: the newest report of a node on /diagnostics, level and message."""
    from diagnostic_msgs.msg import DiagnosticArray

    arrays = probe.collect(DiagnosticArray, '/diagnostics', whole=False)

    def newest(name):
        found = [s for a in arrays for s in a.status if s.name == name]
        return (found[-1].level, found[-1].message) if found else (b'', '')

    return newest


@pytest.mark.parametrize('lockstep', [True, False])
def test_two_controllers_of_one_strut_are_0_v(start, probe, reports, lockstep):
    """Truth: what the coil got, as the samples say. Named by the plant, in its log and as ERROR; reset ends it.

    The controller names both too, the plant that has latched 0 V, and the service that ends it.
    """
    from diagnostic_msgs.msg import DiagnosticStatus
    from satvib_common.struts.applied import Applied
    from std_srvs.srv import Trigger

    from satvib_msgs.msg import StrutAcceleration

    samples = probe.collect(StrutAcceleration, '/strut_1/acceleration')
    plant = start(*PLANT, lockstep=lockstep, lockstep_timeout=60.0, **RIG)
    controller = start(*CONTROLLER, '/strut_1', **LAW)
    probe.wait(lambda: len(samples) > 100 and samples[-1].applied_state == Applied.APPLIED)
    rival = start(*CONTROLLER, '/strut_1', more=SECOND, **LAW)
    probe.wait(lambda: samples[-1].applied_state == Applied.LATCHED)
    assert samples[-1].applied == 0.0
    both = named('strut_1/second', 'strut_1/strut_controller')
    what = f'2 publishers on strut_1/voltage, only one is allowed: {both}'
    probe.wait(lambda: reports('/plant_sim')[0] == DiagnosticStatus.ERROR)
    assert what in reports('/plant_sim')[1]
    assert '0 V, latched: two controllers answer its samples' in plant.said
    assert what in plant.said
    latched = '0 V: latched by /plant_sim, which says why on /diagnostics, until /plant_sim/reset is called'
    # a publisher is found before its node has a name; what names both comes again then
    probe.wait(lambda: f'{latched}; 2 publishers' in controller.said and what in controller.said)
    probe.wait(lambda: latched in reports('/strut_1/strut_controller')[1])
    rival.close()
    assert probe.call(Trigger, '/plant_sim/reset', Trigger.Request()).success
    probe.wait(lambda: samples[-1].applied_state == Applied.APPLIED)


@pytest.mark.parametrize('lockstep', [True, False])
def test_two_plants_end_or_are_0_v(start, probe, lockstep):
    """Truth: the processes and the voltages. One plant ends with exit code 1, or the controller latches 0 V; named.

    The name of the one that has just started may not be known yet to who says so.
    """
    from satvib_msgs.msg import StrutAcceleration, VcaVoltage

    samples = probe.collect(StrutAcceleration, '/strut_1/acceleration')
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    controller = start(*CONTROLLER, '/strut_1', **LAW)
    plants = [start(*PLANT, lockstep=lockstep, **RIG)]
    probe.wait(lambda: len(samples) > 100)
    plants.append(start(*PLANT, lockstep=lockstep, more=SECOND, **RIG))
    probe.wait(
        lambda: (voltages and voltages[-1].fault) or any(p.popen.poll() is not None for p in plants)
    )
    what = re.compile(
        '2 publishers on strut_1/acceleration, only one is allowed: '
        '(/plant_sim, /second|/(plant_sim|second), a node whose name is not known yet)'
    )
    probe.wait(lambda: any(what.search(process.said) for process in (controller, *plants)))
    assert {p.popen.poll() for p in plants} <= {None, 1}


def test_two_identifiers_of_one_strut_are_0_v(start, probe, reports):
    """Truth: the voltage and the reason of the controller. It names both; their models do not alternate for long."""
    from diagnostic_msgs.msg import DiagnosticStatus

    from satvib_msgs.msg import IirParameters, Schedule, VcaVoltage

    models = probe.collect(IirParameters, '/strut_1/identified_model')
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    plan = probe.publisher(Schedule, '/schedule')
    controller = start(*CONTROLLER, '/strut_1', **LAW)
    for more in ((), SECOND):
        start(*IDENTIFIER, '/strut_1', sample_rate=RATE, more=more)
    start(*PLANT, lockstep=False, rig='paper_1dof', disturbance=SHAKE)
    probe.wait(lambda: plan.get_subscription_count() == 4)
    plan.publish(
        Schedule(
            scenario='test', seed=1, sample_period=1.0 / RATE, struts=['strut_1'],
            phases=[0, 1, 2], first_sequence=[0, 50, 150],
        )
    )  # fmt: skip
    probe.wait(lambda: len(models) > 100 and voltages and voltages[-1].fault)
    assert voltages[-1].voltage == 0.0
    both = named('strut_1/second', 'strut_1/strut_identifier')
    what = f'2 publishers on strut_1/identified_model, only one is allowed: {both}'
    probe.wait(lambda: reports('/strut_1/strut_controller')[0] == DiagnosticStatus.ERROR)
    message = reports('/strut_1/strut_controller')[1]
    latch = f'fault: two sources of models, end one of them: {what}; then call ~/reset'
    assert latch in message
    assert message.count(what) == 1
    assert f'0 V: {latch}' in controller.said


def test_one_node_that_publishes_each_sample_twice_is_named(start, probe, reports):
    """Truth: the one publisher of the samples, and of the voltages. Controller and plant latch 0 V and name it."""
    from diagnostic_msgs.msg import DiagnosticStatus

    from satvib_msgs.msg import StrutAcceleration, VcaVoltage

    start(*CONTROLLER, '/strut_1', **LAW)
    start(*PLANT, '/plant', lockstep=False, **RIG)
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    heard = probe.collect(StrutAcceleration, '/plant/strut_1/acceleration')
    samples = probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    answers = probe.publisher(VcaVoltage, '/plant/strut_1/voltage')
    probe.wait(lambda: samples.get_subscription_count() and answers.get_subscription_count())

    def both_are_latched():
        while len(done) < len(heard):
            done.append(sample := heard[len(done)])
            for _ in range(2):
                samples.publish(sample)
                answers.publish(VcaVoltage(sequence=sample.sequence, voltage=1.0))
        return (
            voltages
            and voltages[-1].fault
            and reports('/plant/plant_sim')[0] == DiagnosticStatus.ERROR
        )

    done = []
    probe.wait(both_are_latched)
    what = '/probe publishes each twice or out of order on {}strut_1/{}'.format
    latch = f'fault: samples as of two sources: {what("", "acceleration")}; then call ~/reset'
    probe.wait(lambda: latch in reports('/strut_1/strut_controller')[1])
    latch = f'its samples are answered twice: {what("plant/", "voltage")}; call ~/reset'
    assert latch in reports('/plant/plant_sim')[1]


def test_the_second_of_two_schedules_is_refused(start, probe, reports):
    """Truth: the first schedule. Before any sample, a plan of another node changes nothing and its node is named."""
    import rclpy
    from rclpy.duration import Duration

    from satvib_msgs.msg import Schedule, StrutAcceleration, VcaVoltage

    def plan(phase):
        return Schedule(
            scenario='test', seed=1, sample_period=1.0 / RATE, struts=['strut_1'], phases=[phase],
            first_sequence=[0],
        )  # fmt: skip

    controller = start(
        *CONTROLLER, '/strut_1', sample_rate=RATE, law='off', excitation_amplitude=5.0
    )
    first = probe.publisher(Schedule, '/schedule')
    probe.wait(lambda: first.get_subscription_count() == 1)
    first.publish(plan(2))
    assert first.wait_for_all_acked(Duration(seconds=30))
    assert (
        probe.state_of('/strut_1/strut_controller') == 'active'
    )  # it has worked on what came before
    other = rclpy.create_node('other', context=probe.context)
    second = other.create_publisher(Schedule, '/schedule', first.qos_profile)
    probe.wait(lambda: second.get_subscription_count() == 1)

    def is_named():
        second.publish(
            plan(0)
        )  # again and again, for a publisher is found before its node has a name
        return 'refused: schedule: another one, from /other' in controller.said

    probe.wait(is_named)
    what = '2 publishers on schedule, only one is allowed: /other, /probe'
    probe.wait(lambda: what in reports('/strut_1/strut_controller')[1])
    assert what in controller.said
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    samples = probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    probe.wait(lambda: samples.get_subscription_count() == 1)
    for k in range(1, 60):
        samples.publish(StrutAcceleration(sequence=k, sample_period=1.0 / RATE))
        probe.wait(lambda k=k: voltages and voltages[-1].sequence == k)
    assert max(abs(v.voltage) for v in voltages) > 1.0  # IDENTIFY, as the first one says
    other.destroy_node()
