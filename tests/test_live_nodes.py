# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Single nodes, started as people start them: lifecycle, parameters, signals, bad input, one another's absence."""

import itertools
import math
import signal
import subprocess
import sys

from processes import shared_memory

CONTROLLER = ('satvib_control', 'strut_controller')
IDENTIFIER = ('satvib_ident', 'strut_identifier')
PLANT = ('satvib_plant_sim', 'plant_sim')
RECORDER = ('satvib_bringup', 'recorder')

FAILING = """
from satvib_common.errors import RunError
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.schema import Schema


class Failing(SatvibNode):
    def reset(self):
        raise RunError('the device does not answer')


run_node(lambda: Failing('failing', Schema))
"""


def one_line(process, code, *words):
    """Check the exit code and that the last line names what it must; there is no traceback."""
    assert process.wait() == code, process.said
    lines = process.said.strip().splitlines()
    assert 'Traceback' not in process.said
    for word in words:
        assert word in lines[-1], process.said


def schedule(struts=1, end=0, rate=200.0, phases=((0, 0),)):
    from satvib_msgs.msg import Schedule

    return Schedule(
        scenario='test',
        seed=1,
        sample_period=1.0 / rate,
        struts=[f'strut_{i + 1}' for i in range(struts)],
        phases=[phase for phase, _ in phases],
        first_sequence=[first for _, first in phases],
        end_sequence=end,
    )


def test_lifecycle(start, probe):
    """Truth: the managed-node life cycle of ROS 2 (design.ros2.org), transition by transition."""
    from lifecycle_msgs.msg import Transition

    node = '/strut_1/strut_controller'
    process = start(*CONTROLLER, '/strut_1', autostart=False)
    assert probe.state_of(node) == 'unconfigured'
    for transition, state in [
        (Transition.TRANSITION_CONFIGURE, 'inactive'),
        (Transition.TRANSITION_ACTIVATE, 'active'),
        (Transition.TRANSITION_DEACTIVATE, 'inactive'),
        (Transition.TRANSITION_ACTIVATE, 'active'),
        (Transition.TRANSITION_DEACTIVATE, 'inactive'),
        (Transition.TRANSITION_CLEANUP, 'unconfigured'),
        (Transition.TRANSITION_CONFIGURE, 'inactive'),
    ]:
        assert probe.change_state(node, transition)
        assert probe.state_of(node) == state
    probe.change_state(node, Transition.TRANSITION_INACTIVE_SHUTDOWN)
    assert process.wait() == 0, process.said


def test_parameters_are_checked_as_a_whole_and_applied(start, probe):
    """Truth: ControllerParameters; the node refuses what the dataclass refuses, with its reason.

    What is taken is one line in the log; a name that is none is named, with the one that may be meant.
    """
    from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
    from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParameters

    node = '/strut_1/strut_controller'
    process = start(*CONTROLLER, '/strut_1', slew_limt=1.0)
    said = 'parameter slew_limt: no such parameter; did you mean slew_limit?, ignored'
    probe.wait(lambda: said in process.said)

    def put(name, value):
        number = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)
        request = SetParameters.Request(parameters=[Parameter(name=name, value=number)])
        result = probe.call(SetParameters, f'{node}/set_parameters', request).results[0]
        return result.successful, result.reason

    def get(name):
        request = GetParameters.Request(names=[name])
        return probe.call(GetParameters, f'{node}/get_parameters', request).values[0].double_value

    assert put('voltage_limit', 15.0) == (True, '')
    assert get('voltage_limit') == 15.0
    excited = 'the excitation of IDENTIFY is 5 V at most, too'  # excitation_amplitude is 10 V
    assert put('voltage_limit', 5.0) == (True, excited)
    assert put('voltage_limit', 15.0) == (True, '')
    probe.wait(lambda: process.said.count('voltage_limit: ') == 3)
    for line in ('20.0 -> 15.0', f'15.0 -> 5.0; {excited}', '5.0 -> 15.0'):
        assert f'voltage_limit: {line}\n' in process.said
    hint = 'no such parameter; did you mean velocity_gain?'
    assert put('velocty_gain', 1.0) == (False, f'velocty_gain: {hint}')
    assert put('gain_i', 1.0) == (
        False, 'gain_i: ki adapts (adapted_gains), so its start is not set in a run'
    )  # fmt: skip
    waits = 'acts when a trusted model is taken; until then 0 V'
    assert put('gain_p', 1.0) == (True, waits)
    probe.wait(lambda: f'gain_p: 0.0 -> 1.0; {waits}' in process.said)
    done, reason = put('voltage_limit', -1.0)
    assert not done
    assert 'voltage_limit' in reason
    done, reason = put('sample_rate', 500.0)
    assert not done
    assert reason == (
        'sample_rate is read-only: the other nodes of the graph rely on the same value'
    )
    assert get('voltage_limit') == 15.0
    request = DescribeParameters.Request(names=['voltage_limit', 'sample_rate'])
    limit, rate = probe.call(DescribeParameters, f'{node}/describe_parameters', request).descriptors
    assert limit.description.endswith('[V]')
    assert limit.floating_point_range[0].from_value == 0.0
    assert (limit.read_only, rate.read_only) == (False, True)
    assert 'read-only: the other nodes' in rate.additional_constraints


def test_signals_end_every_node_cleanly(start, probe, tmp_path):
    """Truth: the house rule. SIGINT and SIGTERM: exit 0, no traceback, whatever the node was doing."""
    processes = [
        start(*PLANT),
        start(*CONTROLLER, '/strut_1'),
        start(*IDENTIFIER, '/strut_1'),
        start(*RECORDER, folder=str(tmp_path / 'bag')),
        start('satvib_bringup', 'experiment'),
        start('satvib_bringup', 'schedule', scenario='quick_3dof', more=('-r', 'schedule:=/other')),
    ]
    names = {
        'plant_sim',
        'strut_controller',
        'strut_identifier',
        'recorder',
        'experiment',
        'schedule',
    }
    probe.wait(lambda: names <= set(probe.node.get_node_names()))
    for i, process in enumerate(processes):
        process.send(signal.SIGINT if i % 2 else signal.SIGTERM)
    for process in processes:
        assert process.wait() == 0, process.said
        assert 'Traceback' not in process.said
    assert (tmp_path / 'bag' / 'metadata.yaml').exists()


IN_THE_LOCK = """
import os, signal, sys
from satvib_ident.nodes.strut_identifier_node import main
def hook(frame, event, _):
    turns = frame.f_locals.get('self')
    if event == 'call' and frame.f_code.co_name == 'take' and hasattr(turns, '_there'):
        sys.setprofile(None)
        with turns._there:
            print('in the lock', flush=True)
            os.kill(os.getpid(), signal.SIGTERM)
            sum(range(10000))
sys.setprofile(hook)
main()
"""


def test_a_signal_ends_a_node_that_holds_a_lock(domain, tmp_path):  # noqa: ARG001
    """Truth: the house rule. The signal comes while the main thread holds the lock that waking takes."""
    from satvib_bringup.live.workspace import graph_environment

    done = subprocess.run(
        [sys.executable, '-c', IN_THE_LOCK],
        env=graph_environment(),
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60.0,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, 'in the lock\n', '')


def test_bad_parameters_are_one_line(start, tmp_path):
    """Truth: the issue's bar. Each names what is wrong; exit code 2; nothing is overwritten."""
    (tmp_path / 'file').write_text('mine')
    (tmp_path / 'bag').mkdir()
    cases = [
        (start(*CONTROLLER, sample_rate=0.0), 'sample_rate', 'not above 0'),
        (start(*CONTROLLER, law='magic'), 'law', 'magic'),
        (start(*IDENTIFIER, poles='two'), 'poles', 'whole number'),
        (start(*PLANT, rig='paper_9dof'), 'paper_9dof'),
        (start(*PLANT, rig_overrides=['payload.mass=-1']), 'payload.mass', '-1'),
        (start(*RECORDER, folder=str(tmp_path / 'file' / 'bag')), str(tmp_path / 'file')),
        (start(*RECORDER, folder=str(tmp_path / 'bag')), 'exists already'),
        (start('satvib_bringup', 'replay', file='none.csv'), 'none.csv'),
    ]
    for process, *words in cases:
        one_line(process, 2, *words)
    assert (tmp_path / 'file').read_text() == 'mine'
    assert list((tmp_path / 'bag').iterdir()) == []


SINE = '{kind: sine, amplitude: 1, frequency: 10}'
# arguments after --ros-args: words of the last line
BAD_ARGUMENTS = {
    ('-p', f'disturbance:={SINE}'): (SINE, 'Unknown YAML event', '-p "disturbance:=\'{'),
    ('-p', 'failures:=[{kind: sensor_lost, strut: 1, time: 5}]'): ('failures:=', 'needs quotes'),
    ('-p', 'rig:=[1, a]'): ('rig:=[1, a]', 'same type'),
    ('-p', 'rig'): ("'-p rig'",),
    ('-r', 'nothing'): ("'-r nothing'",),
    ('--params-file', 'none.yaml'): ('none.yaml', 'opening YAML file'),
    ('--log-level', 'loud'): ('--log-level loud', 'severity'),
    ('--loud',): ('--loud',),
    ('-p', 'use_sim_time:=perhaps'): ('use_sim_time', 'BOOL'),
}


def test_arguments_that_ros_cannot_read_are_one_line(start):
    """Truth: the arguments above; the last line names them, without a place in the sources of ROS; exit code 2."""
    processes = {given: start(*PLANT, more=given) for given in BAD_ARGUMENTS}
    for given, words in BAD_ARGUMENTS.items():
        one_line(processes[given], 2, 'plant_sim: ', *words)
        assert '/src/' not in processes[given].said


def test_a_disturbance_is_given_as_the_page_shows_it(start, probe):
    """Truth: the line of docs/nodes.md; the plant takes it and waits for its schedule."""
    process = start(*PLANT, more=('-p', f"disturbance:='{SINE}'"))
    probe.wait(lambda: 'waits for the schedule' in process.said or process.popen.poll() is not None)
    assert process.popen.poll() is None


def test_a_wrong_domain_is_one_line(start, monkeypatch):
    """Truth: the ROS_DOMAIN_ID of this test, which is no number."""
    monkeypatch.setenv('ROS_DOMAIN_ID', 'mine')
    one_line(start(*PLANT), 2, 'plant_sim: ', 'ROS_DOMAIN_ID')


def test_a_typing_mistake_is_pointed_out(start, probe):
    """Truth: ROS passes over unknown parameters in silence; the node must not."""
    process = start(*CONTROLLER, '/strut_1', voltage_limt=12.0)
    probe.wait(lambda: 'did you mean voltage_limit?' in process.said)


def test_another_sample_rate_is_refused(start, probe):
    """Truth: 0.005 s is not 1 / 100 Hz. One message may be damaged; the second that says the same ends the node."""
    from satvib_msgs.msg import StrutAcceleration

    processes = [start(*CONTROLLER, '/strut_1'), start(*IDENTIFIER, '/strut_1')]
    out = probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    probe.wait(lambda: out.get_subscription_count() == 2)
    out.publish(StrutAcceleration(sample_period=0.005))
    for process in processes:
        probe.wait(lambda process=process: 'refused: strut_1 acceleration' in process.said)
        assert process.popen.poll() is None
    out.publish(StrutAcceleration(sample_period=0.005))
    for process in processes:
        one_line(process, 2, 'strut_1 acceleration', 'sample_period', '0.005')


def test_a_damaged_model_of_the_time_before_ends_no_controller(start, probe):
    """A controller that is started again gets the newest models of the run, and one of them may be damaged.

    Truth: the rule of `Fit`: one message that does not fit is refused; a second one that is wrong in another way, too.
    """
    from rclpy.duration import Duration

    from satvib_msgs.msg import IirParameters

    controller = start(*CONTROLLER, '/strut_1', sample_rate=200.0)
    out = probe.publisher(IirParameters, '/strut_1/identified_model')
    probe.wait(lambda: out.get_subscription_count() == 1)
    good = {'a': [0.0], 'b': [1.0], 'covariance': [0.0] * 4, 'delay': 1}
    for wrong in ({'sample_period': 1.28}, {'covariance': [0.0] * 3}, {'sample_period': math.nan}):
        out.publish(IirParameters(**{'sample_period': 0.005, **good, **wrong}))
    out.publish(IirParameters(sample_period=0.005, **good))
    out.publish(IirParameters(**good, sample_period=math.nan))
    assert out.wait_for_all_acked(Duration(seconds=30))
    assert probe.state_of('/strut_1/strut_controller') == 'active'
    assert 'refused: strut_1 identified_model: sample_period is 1.28 s' in controller.said
    assert controller.popen.poll() is None


def test_a_model_that_no_law_can_use_ends_no_run(start, probe):
    """Truth: the rule of `Fit`, and the samples after the one with which the model would be taken are answered."""
    from rclpy.duration import Duration
    from satvib_common.phases import Phase

    from satvib_msgs.msg import IirParameters, Schedule, StrutAcceleration, VcaVoltage

    controller = start(*CONTROLLER, '/strut_1', sample_rate=200.0)
    models = probe.publisher(IirParameters, '/strut_1/identified_model')
    samples = probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    answers = probe.collect(VcaVoltage, '/strut_1/voltage')
    plan = probe.publisher(Schedule, '/schedule')
    every = (models, samples, plan)
    probe.wait(lambda: all(out.get_subscription_count() == 1 for out in every))
    plan.publish(schedule(phases=((Phase.IDENTIFY, 0), (Phase.CONTROL, 5))))

    def answered(k):
        samples.publish(StrutAcceleration(sequence=k, sample_period=0.005))
        probe.wait(lambda: answers and answers[-1].sequence == k)

    for k in range(4):
        answered(k)
    base = {'sequence': 3, 'sample_period': 0.005, 'converged': True}
    long = {'a': [0.0], 'b': [1.0], 'covariance': [0.0] * 4, 'delay': 65535}
    models.publish(IirParameters(**base, **long))
    models.publish(IirParameters(**base, a=[0.5], covariance=[1.0], delay=1))
    assert models.wait_for_all_acked(Duration(seconds=30))
    for k in range(4, 10):
        answered(k)
    assert 'refused: strut_1 identified_model: ' in controller.said
    assert controller.popen.poll() is None


def test_the_plant_refuses_a_voltage_that_is_no_number(start, probe):
    """Truth: the issue's bar. One line with strut and sample, exit code 2."""
    from satvib_msgs.msg import Schedule, StrutAcceleration, VcaVoltage

    process = start(*PLANT, rig='paper_1dof')
    samples = probe.collect(StrutAcceleration, '/strut_1/acceleration')
    out = probe.publisher(VcaVoltage, '/strut_1/voltage')
    probe.publisher(Schedule, '/schedule').publish(schedule())
    probe.wait(lambda: len(samples) == 1)
    out.publish(VcaVoltage(sequence=0, voltage=1.0))
    probe.wait(lambda: len(samples) == 2)
    out.publish(VcaVoltage(sequence=1, voltage=math.nan))
    one_line(process, 2, 'strut_1', 'sample 1', 'nan')


def test_the_plant_does_not_wait_for_ever(start, probe):
    """Truth: the design. A strut that does not answer is named; exit code 1."""
    from satvib_msgs.msg import Schedule, StrutAcceleration, VcaVoltage

    process = start(*PLANT, rig='paper_3dof', lockstep_timeout=0.5)
    outs = [probe.publisher(VcaVoltage, f'/strut_{i}/voltage') for i in (1, 3)]
    samples = probe.collect(StrutAcceleration, '/strut_1/acceleration')
    probe.publisher(Schedule, '/schedule').publish(schedule(3, rate=100.0))
    probe.wait(lambda: samples)
    for out in outs:
        out.publish(VcaVoltage(sequence=0))
    one_line(process, 1, 'no voltage for sample 0 from strut_2 within 0.5 s')


def test_the_plant_refuses_a_schedule_for_other_struts(start, probe):
    """Truth: a 3-DOF rig has three struts, this schedule one."""
    from satvib_msgs.msg import Schedule

    process = start(*PLANT, rig='paper_3dof')
    probe.publisher(Schedule, '/schedule').publish(schedule(1, rate=100.0))
    one_line(process, 2, 'schedule', 'strut_1, strut_2, strut_3')


def test_real_time_follows_the_clock_and_a_silent_controller_means_0_v(start, probe):
    """Truth: the design. Stamps one period apart, no sample left out, 0 V after silence."""
    from diagnostic_msgs.msg import DiagnosticArray
    from satvib_common.ros.convert import nanoseconds

    from satvib_msgs.msg import Schedule, StrutAcceleration, StrutTruth, VcaVoltage

    end = 400
    process = start(*PLANT, rig='paper_1dof', lockstep=False, truth_period=0.0)
    samples = probe.collect(StrutAcceleration, '/strut_1/acceleration')
    truth = probe.collect(StrutTruth, '/strut_1/truth')
    diagnostics = probe.collect(DiagnosticArray, '/diagnostics', whole=False)
    out = probe.publisher(VcaVoltage, '/strut_1/voltage')
    probe.publisher(Schedule, '/schedule').publish(schedule(end=end))
    probe.wait(lambda: out.get_subscription_count() == 1 and samples)
    out.publish(VcaVoltage(sequence=samples[-1].sequence, voltage=5.0))
    assert process.wait() == 0, process.said
    assert (
        process.said.strip().splitlines()[-1].startswith('plant_sim: 400 samples of 1 struts, 2 s')
    )
    probe.wait(lambda: len(samples) == end and len(truth) == end)
    assert [s.sequence for s in samples] == list(range(end))
    stamps = [nanoseconds(s.header.stamp) for s in samples]
    assert {b - a for a, b in itertools.pairwise(stamps)} == {5_000_000}
    currents = [abs(t.current) for t in truth]
    assert max(currents) > 0.1
    assert currents[-1] < 1e-3 * max(currents)
    complaints = {s.message for d in diagnostics for s in d.status if s.name == '/plant_sim'}
    assert any('strut_1: 0 V: no fresh voltage for 50 ms' in text for text in complaints)


def test_a_restarted_controller_joins_the_run(start, probe):
    """Truth: the schedule. The plant gets an answer to every sample, from whichever process, and ends by itself."""
    from satvib_msgs.msg import Schedule, VcaVoltage

    end = 800
    plant = start(*PLANT, rig='paper_1dof', lockstep_timeout=60.0)
    loop = {'sample_rate': 200.0, 'lockstep': True}
    start(*IDENTIFIER, '/strut_1', **loop)
    first = start(*CONTROLLER, '/strut_1', **loop)
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    phases = ((1, 0), (2, 100), (4, 300))
    probe.publisher(Schedule, '/schedule').publish(schedule(end=end, phases=phases))
    probe.wait(lambda: voltages and voltages[-1].sequence > 350)
    first.send(signal.SIGKILL)
    first.wait()
    start(*CONTROLLER, '/strut_1', **loop)
    assert plant.wait() == 0, plant.said
    probe.wait(lambda: voltages[-1].sequence == end - 1)
    assert {v.sequence for v in voltages} == set(range(end))


def test_stop_and_reset(start, probe):
    """Truth: the design. After stop the voltage is 0 with a latched fault; reset releases it."""
    from rclpy.duration import Duration
    from std_srvs.srv import Trigger

    from satvib_msgs.msg import Schedule, StrutAcceleration, VcaVoltage

    start(*CONTROLLER, '/strut_1')
    samples = probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    plan = probe.publisher(Schedule, '/schedule')
    probe.wait(lambda: plan.get_subscription_count() == samples.get_subscription_count() == 1)
    plan.publish(schedule(rate=100.0, phases=((2, 0),)))
    # for the excitation is 0 V again after 25 samples
    assert plan.wait_for_all_acked(Duration(seconds=60.0))

    def answer(k):
        samples.publish(StrutAcceleration(sequence=k, sample_period=0.01))
        return probe.wait(lambda: next((v for v in voltages if v.sequence == k), None))

    k = 0
    while answer(k).voltage == 0.0:  # until the schedule has arrived and the excitation begins
        k += 1
        assert k < 1000
    for name, fault in (('stop', True), ('reset', False)):
        assert probe.call(Trigger, f'/strut_1/strut_controller/{name}', Trigger.Request()).success
        k += 1
        found = answer(k)
        assert found.fault is fault
        assert (found.voltage == 0.0) is fault


def test_a_node_tells_whom_it_has_found(start, probe):
    """Truth: the probe's own reader and writer, one of each."""
    from diagnostic_msgs.msg import DiagnosticArray

    from satvib_msgs.msg import StrutAcceleration, VcaVoltage

    start(*CONTROLLER, '/strut_1')
    arrays = probe.collect(DiagnosticArray, '/diagnostics', whole=False)

    def said(key):
        return [
            int(value.value)
            for array in arrays
            for value in array.status[0].values
            if value.key == key
        ][-1:]

    heard, hears = 'readers of /strut_1/voltage', 'writers of /strut_1/acceleration'
    probe.wait(lambda: said(heard) == said(hears) == [0])
    probe.collect(VcaVoltage, '/strut_1/voltage')
    probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    probe.wait(lambda: said(heard) == said(hears) == [1])


def start_process(start, process):
    """Start one of a described graph."""
    start(
        process.package, process.executable, process.namespace,
        **process.nodes[0].parameters, more=('-r', f'__node:={process.name}'),
    )  # fmt: skip


def test_real_time_begins_when_all_have_found_one_another(start, probe):
    """Truth: what a node says of itself. The runner's graph is complete, yet a node says that it hears nothing."""
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
    from satvib_bringup.live.graph import graph_of
    from satvib_bringup.live.observer import Observer
    from satvib_experiment.scenario.scenario import load_scenario

    graph = graph_of(load_scenario('paper_1dof_10hz'), realtime=True)
    with Observer(graph) as observer:
        for process in graph.processes:
            start_process(start, process)
        probe.wait(lambda: not observer.missing())
        deaf = DiagnosticStatus(
            name='/strut_1/strut_controller',
            values=[KeyValue(key='writers of /strut_1/acceleration', value='0')],
        )
        probe.publisher(DiagnosticArray, '/diagnostics').publish(DiagnosticArray(status=[deaf]))
        lacking = ['strut_1/strut_controller without writers of /strut_1/acceleration']
        probe.wait(lambda: observer.missing() == lacking)
        probe.wait(lambda: not observer.missing())


def test_the_schedule_of_real_time_waits_for_who_comes_late(start, probe):
    """Truth: the first hundred samples, one by one. The controller comes long after schedule and plant."""
    from satvib_bringup.live.graph import graph_of
    from satvib_bringup.live.process import Stage
    from satvib_experiment.scenario.scenario import load_scenario

    from satvib_msgs.msg import VcaVoltage

    graph = graph_of(load_scenario('paper_1dof_10hz'), realtime=True)
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    start('satvib_bringup', 'schedule', scenario='paper_1dof_10hz', realtime=True)
    late = [process for process in graph.processes if process.stage == Stage.CONTROLLER]
    for process in graph.processes:
        if process not in late:
            start_process(start, process)
    there = {'schedule', 'plant_sim', 'strut_identifier'}
    probe.wait(lambda: there <= set(probe.node.get_node_names()))
    for process in late:
        start_process(start, process)
    probe.wait(lambda: len(voltages) >= 100)
    assert [voltage.sequence for voltage in voltages[:100]] == list(range(100))


def test_an_ended_node_is_gone_and_leaves_no_file(start, probe):
    """Truth: the graph of before, and the kernel's list of what is in the memory of a process.

    The lease of DDS would keep an ended node for 20 s. What uses no shared memory leaves nothing there, killed or not.
    """
    for package, executable in (CONTROLLER, IDENTIFIER, PLANT):
        names = set(probe.node.get_node_names())
        process = start(package, executable, '/strut_1' if package != 'satvib_plant_sim' else '/')
        probe.wait(lambda executable=executable: executable in probe.node.get_node_names())
        assert shared_memory(process.popen.pid) == set()
        process.send(signal.SIGINT)
        assert process.wait() == 0, process.said
        probe.wait(lambda names=names: set(probe.node.get_node_names()) == names, limit=10.0)


def test_a_schedule_from_a_stranger_changes_nothing(start, probe):
    """Truth: the rules of `ScheduleGate`. Plant and controller go on for 300 samples, in the phase that they had.

    The stranger tries an unknown phase, an end that is over, one that is never reached, and other struts.
    """
    import rclpy

    from satvib_msgs.msg import ControllerState, Schedule, StrutAcceleration, VcaVoltage

    plant = start(*PLANT, rig='paper_1dof')
    controller = start(*CONTROLLER, '/strut_1', sample_rate=200.0, lockstep=True)
    samples = probe.collect(StrutAcceleration, '/strut_1/acceleration')
    states = probe.collect(ControllerState, '/strut_1/controller_state')
    held = probe.collect(VcaVoltage, '/strut_1/voltage')
    own = probe.publisher(Schedule, '/schedule')
    own.publish(schedule(end=0))
    probe.wait(lambda: len(held) >= 20 and samples)
    stranger = rclpy.create_node('stranger', context=probe.context)
    out = stranger.create_publisher(Schedule, '/schedule', own.qos_profile)
    probe.wait(lambda: out.get_subscription_count() == 2)
    for message in (
        schedule(phases=((9, 0),)), schedule(end=1), schedule(end=2**64 - 1), schedule(3), schedule(rate=100.0),
        schedule(phases=((4, 0),)),
    ):  # fmt: skip
        out.publish(message)
    before = len(states)
    probe.wait(lambda: len(states) >= before + 300)
    assert {state.phase for state in states} == {0}
    for process in (plant, controller):
        probe.wait(lambda process=process: 'refused: schedule' in process.said)
        assert process.popen.poll() is None
    # a run whose own publisher has gone, as that of one message sent by hand, stays that run
    probe.node.destroy_publisher(own)
    probe.wait(lambda: probe.node.count_publishers('/schedule') == 1)
    refused = [process.said.count('refused: schedule') for process in (plant, controller)]
    before = len(states)
    while len(states) < before + 300:
        out.publish(schedule(phases=((4, 0),)))
        seen = len(states)
        probe.wait(lambda seen=seen: len(states) >= seen + 50)
    assert {state.phase for state in states} == {0}
    for process, count in zip((plant, controller), refused, strict=True):
        # the lines of a flood are one for each second, so it must last until the next one
        while process.said.count('refused: schedule') <= count:
            out.publish(schedule(phases=((4, 0),)))
            seen = len(states)
            probe.wait(lambda seen=seen: len(states) >= seen + 50)
    stranger.destroy_node()


def test_a_schedule_of_another_rate_ends_no_controller_that_acts(start, probe):
    """Also without a schedule: one message from a stranger would be 0 V until somebody comes.

    Truth: the rule of `ScheduleGate`; 100 more samples are answered. Before the first sample the same message ends it,
    because then it was started wrongly.
    """
    from satvib_msgs.msg import Schedule, StrutAcceleration, VcaVoltage

    controller = start(*CONTROLLER, '/strut_1', sample_rate=200.0, control_at_start=True)
    samples = probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    held = probe.collect(VcaVoltage, '/strut_1/voltage')
    out = probe.publisher(Schedule, '/schedule')
    probe.wait(lambda: out.get_subscription_count() == samples.get_subscription_count() == 1)

    def answered(k):
        samples.publish(StrutAcceleration(sequence=k, sample_period=0.005))
        probe.wait(lambda: any(v.sequence == k for v in held[-9:]))

    for k in range(20):
        answered(k)
    out.publish(schedule(rate=100.0))
    samples.publish(StrutAcceleration(sequence=20, sample_period=0.01))
    for k in range(20, 120):
        answered(k)
    probe.wait(lambda: controller.said.count('refused: ') >= 1)
    assert controller.popen.poll() is None


def test_a_service_that_fails_says_so_and_the_node_lives_on(start, probe, tmp_path):
    """As ~/reset of a daq_bridge whose guardian does not start. Truth: the response, twice, and exit code 0."""
    from std_srvs.srv import Trigger

    path = tmp_path / 'failing.py'
    path.write_text(FAILING)
    process = start.script(path)
    for _ in range(2):
        response = probe.call(Trigger, '/failing/reset', Trigger.Request())
        assert (response.success, response.message) == (False, 'the device does not answer')
    process.send(signal.SIGINT)
    assert process.wait() == 0
    assert 'Traceback' not in process.said
