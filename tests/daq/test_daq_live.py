# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The real node, guardian and serial line against the emulator. Truth: the states' diagram; the device's terminals."""

import os
import signal
import time
from pathlib import Path

import pytest

LOOPBACK = {'back_end': 'loopback', 'options': {'pace': 'lockstep'}}


def test_a_whole_life(stand):
    """Configure, learn, arm, drive, stop, arm again, estop, reset, SIGTERM: each state in its turn with its reason, and
    exit code 0. In lockstep, so that no machine is too slow for it."""
    stand.write_channels(**LOOPBACK)
    stand.start_bridge(wait_for_schedule=False)
    stand.until_state('IDLE')
    stand.start_answerers()
    stand.drive()
    assert stand.call('stop') == (True, '0 V, IDLE')
    stand.until_state('IDLE')
    assert stand.call('reset')[0] is False
    stand.drive()
    assert stand.call('estop')[0]
    stand.until_state('ESTOP')
    granted, why = stand.call('arm')
    assert not granted
    assert 'refused in ESTOP' in why
    assert stand.call('reset')[0]
    stand.until_state('IDLE')
    stand.drive()
    assert stand.end('bridge') == [0]
    assert 'Traceback' not in stand.said('bridge')
    stand.until_state('IDLE')
    once = ['IDLE', 'ARMED', 'ACTIVE']
    seen = [state for state, _ in stand.states]
    assert seen == [*once, *once, 'ESTOP', *once, 'IDLE']
    assert all(reason for _, reason in stand.states)


def test_the_lifecycle_by_hand(stand):
    """Without autostart every transition is asked for; a latched fault survives cleaning up; activating moves
    nothing."""
    stand.write_channels(**LOOPBACK)
    stand.start_bridge(wait_for_schedule=False, autostart=False)
    assert stand.transition('configure')
    stand.until_state('IDLE')
    granted, why = stand.call('arm')
    assert (granted, why) == (False, 'the node is not active')
    assert stand.transition('activate')
    stand.start_answerers()
    stand.drive()
    assert stand.transition('deactivate')
    stand.until_state('IDLE')
    assert stand.transition('activate')
    assert stand.state == 'IDLE'
    assert stand.call('estop')[0]
    assert stand.transition('deactivate')
    assert stand.transition('cleanup')
    stand.until_state('UNCONFIGURED')
    assert stand.transition('configure')
    stand.until_state('ESTOP')
    assert 'still latched' in stand.states[-1][1]
    assert stand.transition('activate')
    assert stand.call('reset')[0]
    stand.until_state('IDLE')
    assert stand.transition('deactivate')
    stand.channels.write_text('back_end: gpib\nstruts: {}\n')
    assert stand.transition('cleanup')
    assert not stand.transition('configure')
    assert 'back_end' in stand.said('bridge')


def test_bad_channels_are_refused_at_configure_in_one_line(stand):
    """Truth: exit code 2 and one line that names file and channel."""
    stand.write_channels(coil={'gain': 1.0})
    bridge = stand.start_bridge()
    assert bridge.wait(60) == 2
    (line,) = [text for text in stand.said('bridge').splitlines() if 'strut_1' in text]
    assert line.startswith('daq_bridge: ')
    assert 'channels.yaml: strut_1: coil.limit: 20 V at the coil is 20 V at the converter' in line
    assert 'Traceback' not in stand.said('bridge')


def test_a_device_that_is_not_there_is_said_in_one_line(stand):
    stand.write_channels()
    bridge = stand.start_bridge()
    assert bridge.wait(60) == 2
    assert 'the port cannot be opened' in stand.said('bridge')
    assert 'Traceback' not in stand.said('bridge')


def test_it_says_what_a_run_waits_for(stand):
    """Truth: what was given. First the schedule, by its full name, then somebody who arms it."""
    from satvib_common.ros.qos import offered

    from satvib_msgs.msg import Schedule

    stand.write_channels(**LOOPBACK)
    stand.start_bridge()
    stand.until_state('IDLE')
    waits = 'waits for the schedule on /schedule, on which no node publishes'
    stand.until(lambda: waits in stand.said('bridge'), 'a line about the schedule')
    plan = stand.node.create_publisher(Schedule, '/schedule', offered(1))
    stand.start_answerers()
    struts = ['strut_1', 'strut_2', 'strut_3']
    plan.publish(Schedule(sample_period=0.01, struts=struts, phases=[0], first_sequence=[0]))
    stand.until(lambda: 'waits for ~/arm' in stand.said('bridge'), 'a line about ~/arm')
    stand.drive()


def test_a_second_publisher_is_refused(stand):
    """While it drives, as a fault; and at arming, with the reason."""
    stand.write_channels(**LOOPBACK)
    stand.start_bridge(wait_for_schedule=False)
    stand.start_answerers()
    stand.until_state('IDLE')
    stand.drive()
    from satvib_common.ros.qos import offered

    from satvib_msgs.msg import VcaVoltage

    publisher = stand.node.create_publisher(VcaVoltage, '/strut_2/voltage', offered(1))
    stand.until_state('FAULT')
    assert '2 publishers on strut_2/voltage' in stand.states[-1][1]
    stand.call('reset')
    granted, why = stand.call('arm')
    assert not granted
    assert '2 publishers on strut_2/voltage' in why
    stand.node.destroy_publisher(publisher)
    stand.drive()


def test_a_schedule_of_a_stranger_ends_no_run(stand):
    """Truth: the plan that the run began with. It makes no difference whether its publisher is still there."""
    from satvib_common.ros.qos import offered

    from satvib_msgs.msg import Schedule

    stand.write_channels(**LOOPBACK)
    stand.start_bridge()
    stand.until_state('IDLE')
    own = stand.node.create_publisher(Schedule, '/schedule', offered(1))
    stand.start_answerers()
    struts = ['strut_1', 'strut_2', 'strut_3']
    plan = {'sample_period': 0.01, 'struts': struts, 'phases': [4], 'first_sequence': [0]}
    own.publish(Schedule(**plan))
    stand.drive()
    stranger = stand.another_node('stranger')
    out = stranger.create_publisher(Schedule, '/schedule', offered(1))
    for publishers in (2, 1):
        if publishers == 1:
            stand.node.destroy_publisher(own)
        stand.until(lambda n=publishers: stranger.count_publishers('/schedule') == n, 'publishers')
        stand.until(lambda: out.get_subscription_count() == 1, 'the bridge')
        for change in (
            {'phases': [9]},
            {'end_sequence': 1},
            {'end_sequence': 2**64 - 1},
            {'phases': [0]},
        ):
            out.publish(Schedule(**plan | change))
            stand.latest.clear()
            stand.until(lambda: 'sequence' in stand.latest, 'figures')
        assert stand.state == 'ACTIVE'
        assert stand.children['bridge'].poll() is None
    said = stand.said('bridge')
    assert 'refused: schedule: another one while a run is on, from /stranger' in said
    stranger.destroy_node()


def test_an_unplugged_device_and_its_return(stand):
    """The device goes: FAULT with its reason. It is back: reset opens it again, and the samples count on."""
    stand.write_channels()
    stand.start_emulator()
    stand.start_bridge(wait_for_schedule=False)
    stand.start_answerers()
    stand.until_state('IDLE')
    stand.drive()
    stand.kill('emulator')
    stand.children.pop('emulator').wait(60)
    stand.port.unlink()
    stand.until_state('FAULT')
    # on a busy machine the silence may be noticed before the end
    assert any(t in stand.states[-1][1] for t in ('the line is gone', 'stale', 'no sample'))
    stand.latest.clear()
    stand.until(lambda: 'sequence' in stand.latest, 'figures')
    before = int(stand.latest['sequence'])
    granted, why = stand.call('reset')
    assert not granted
    assert 'the port cannot be opened' in why
    stand.start_emulator()
    assert stand.call('reset')[0]
    stand.until_state('IDLE')
    stand.drive()
    stand.latest.clear()
    stand.until(lambda: 'sequence' in stand.latest, 'figures')
    assert int(stand.latest['sequence']) > before


EVERYTHING = ('guardian', 'bridge', 'answerer_1', 'answerer_2')


@pytest.mark.parametrize(
    'victims', [('bridge',), ('guardian',), ('answerer_1',), EVERYTHING], ids='+'.join
)
def test_kill_9(stand, victims):
    """SIGKILL of each part and of all at once: 0 V at the terminals, and FAULT where there is a bridge to say so. How
    long it takes is measured by benchmarks/daq_kill.py."""
    stand.write_channels()
    stand.start_emulator()
    stand.start_bridge(wait_for_schedule=False)
    stand.start_answerers()
    stand.until_state('IDLE')
    stand.drive()
    moment = stand.kill(*victims)
    _, why = stand.zero_after(moment)
    assert why
    if 'bridge' not in victims:
        stand.until_state('FAULT')


def test_a_guardian_that_was_killed_is_replaced_by_reset(stand):
    stand.write_channels()
    stand.start_emulator()
    stand.start_bridge(wait_for_schedule=False)
    stand.start_answerers()
    stand.until_state('IDLE')
    stand.drive()
    stand.zero_after(stand.kill('guardian'))
    stand.until_state('FAULT')
    assert 'guardian was killed by SIGKILL' in stand.states[-1][1] or 'stale' in stand.states[-1][1]
    assert stand.call('reset')[0]
    stand.until_state('IDLE')
    stand.drive()


@pytest.mark.parametrize('victim', ['bridge', 'guardian'])
def test_a_process_that_hangs_is_0_v_too(stand, victim):
    """SIGSTOP, which no process notices: a bridge that hangs leaves its commands to grow old, a guardian that hangs
    leaves the device alone; the bridge then replaces it."""
    stand.write_channels()
    stand.start_emulator()
    stand.start_bridge(wait_for_schedule=False)
    stand.start_answerers()
    stand.until_state('IDLE')
    stand.drive()
    pid = stand.guardian() if victim == 'guardian' else stand.children['bridge'].pid
    os.kill(pid, signal.SIGSTOP)
    stand.zero_after(time.monotonic() - 0.05)
    if victim == 'guardian':
        stand.until_state('FAULT')
        stand.until(lambda: not Path(f'/proc/{pid}').exists(), 'the end of the guardian that hangs')
        assert stand.call('reset')[0]
    else:
        os.kill(pid, signal.SIGCONT)
        stand.until_state('FAULT')
