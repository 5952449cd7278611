# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib watch` over real DDS, HTTP and WebSocket, with nodes that others have started."""

import os
import signal
import subprocess
import sys
import urllib.request

import pytest
from graphs import RATE, begin
from watching import LIMIT, Client, found_in


@pytest.mark.parametrize('frame', ['', 'strut_1', 'a', 'ab', 'abc', 'abcd', 'x' * 77])
def test_bytes_of_a_sample_are_read_where_they_are(frame):
    """Truth: the middleware's own serialization, for every alignment of the frame's name."""
    from rclpy.serialization import serialize_message
    from satvib_experiment.recording.cdr import acceleration_figures, sequence_and_figures

    from satvib_msgs.msg import StrutAcceleration, VcaVoltage

    sample = StrutAcceleration(
        sequence=7, sample_period=0.01, upper=1.5, lower=-2.5, upper_clipped=True, applied=3.25, applied_state=5
    )  # fmt: skip
    sample.header.frame_id = frame
    assert acceleration_figures(serialize_message(sample)) == (7, 0.01, 1.5, -2.5, 3.25, 5)
    voltage = VcaVoltage(header=sample.header, sequence=8, voltage=-9.5)
    assert sequence_and_figures(serialize_message(voltage), 1) == (8, -9.5)


def test_stop_of_one_strut_leaves_the_others_and_stop_of_all_leaves_none(
    start, schedule, probe, client
):
    """Truth: the messages on /strut_i/voltage that another node of the domain hears."""
    from satvib_msgs.msg import VcaVoltage

    begin(start)
    heard = [probe.collect(VcaVoltage, f'/strut_{i}/voltage', whole=False) for i in (1, 2, 3)]
    schedule()
    probe.wait(lambda: all(v and v[-1].voltage != 0.0 for v in heard))
    client.wait(lambda: len(client.struts) == 3 and all(s['state'] for s in client.struts.values()))
    # what the coils got is shown beside what was asked for
    client.wait(lambda: any(client.struts['strut_1']['blocks']['high'][3]))
    client.send(do='stop', strut='strut_2')
    probe.wait(lambda: heard[1][-1].fault)
    counts = [len(v) for v in heard]
    probe.wait(lambda: all(len(v) > n + 20 for v, n in zip(heard, counts, strict=True)))
    assert [v[-1].fault for v in heard] == [False, True, False]
    client.send(do='stop')
    probe.wait(lambda: all(v[-1].voltage == 0.0 and v[-1].fault for v in heard))
    client.said('/strut_1/strut_controller stop', '0 V')
    state = client.wait(
        lambda: (s := client.struts['strut_1']['state']).get('fault') and s['voltage'] == 0.0 and s
    )
    assert state['reason']
    client.send(do='reset')
    probe.wait(lambda: all(v[-1].voltage != 0.0 for v in heard))


def test_struts_in_any_namespace_are_found_and_two_pages_see_the_same(
    start, schedule, probe, client, open_client
):
    """Truth: the samples that another node of the domain hears; four digits are shown."""
    from satvib_msgs.msg import StrutAcceleration

    begin(start, '/lab/rig_a', struts=1)
    heard = probe.collect(StrutAcceleration, '/lab/rig_a/strut_1/acceleration')
    schedule('/lab/rig_a', struts=3)
    name = 'lab/rig_a/strut_1'
    client.wait(lambda: name in client.struts and client.struts[name]['blocks']['last'] > 100)
    client.wait(lambda: client.struts[name]['phase'] == 'CONTROL')  # of the first state
    other = open_client()
    other.wait(lambda: name in other.struts and other.struts[name]['blocks']['last'] > 100)
    strut = client.struts[name]
    assert strut['state']['law'] == 'velocity_feedback'
    assert strut['nodes']['voltage'] == ['/lab/rig_a/strut_1/strut_controller']
    assert client.newest['scenario'] == 'by hand'
    blocks = other.struts[name]['blocks']
    size, last = blocks['size'], blocks['last']
    probe.wait(lambda: heard and heard[-1].sequence >= (last + 1) * size)
    upper = {m.sequence: m.upper for m in heard}
    whole = [upper.get(k) for k in range(last * size, (last + 1) * size)]
    assert blocks['high'][0][-1] == pytest.approx(max(whole), rel=1e-3)
    assert blocks['low'][0][-1] == pytest.approx(min(whole), rel=1e-3)


def test_parameters_are_shown_and_set_as_the_nodes_describe_them(start, schedule, client):
    """Truth: the schema of the controller: `leakage` has a range and may change, `sample_rate` may not."""
    begin(start, struts=1)
    schedule()
    node = '/strut_1/strut_controller'
    client.wait(
        lambda: node in client.struts.get('strut_1', {'nodes': {}})['nodes'].get('voltage', [])
    )
    client.send(do='parameters', node=node)
    found = client.wait(lambda: client.parameters)
    by_name = {p['name']: p for p in found['parameters']}
    assert by_name['sample_rate']['fixed']
    assert by_name['sample_rate']['value'] == RATE
    limit = by_name['voltage_limit']
    assert not limit['fixed']
    assert '[V]' in limit['text']
    client.parameters = None
    client.send(do='set', node=node, parameter='voltage_limit', value=limit['value'] / 2)
    found = client.wait(lambda: client.parameters)
    by_name = {p['name']: p for p in found['parameters']}
    assert by_name['voltage_limit']['value'] == limit['value'] / 2
    client.wait(
        lambda: node in client.newest.get('changed', []) or client.said(node, 'voltage_limit =')
    )
    client.send(do='set', node=node, parameter='voltage_limit', value=-1.0)
    client.said(node, 'voltage_limit:')
    client.send(do='set', node=node, parameter='voltage_limit', value='much')
    client.said("'much' is no value for it")
    client.send(do='set', node='/elsewhere', parameter='voltage_limit', value=1.0)
    client.said("'/elsewhere' is no node that is heard")
    client.send(do='arm')
    client.said('arm: there is no hardware here')


def test_recording_is_switched_on_and_off(start, schedule, client, watch):
    """Truth: the bag, read by the reader of the reports."""
    from rosbags.highlevel import AnyReader

    begin(start, struts=1)
    schedule()
    client.wait(lambda: client.struts.get('strut_1', {}).get('state'))
    client.send(do='record', on=True)
    client.wait(lambda: client.newest['recording'])
    client.wait(lambda: any('watch_recorder' in name for name in client.nodes))
    client.wait(lambda: int(client.nodes['/watch_recorder']['figures'].get('messages', 0)) > 100)
    client.send(do='record', on=False)
    client.said('recorded:')
    assert client.newest['recording'] == ''
    (bag,) = (watch.folder / 'runs').glob('*/bag')
    with AnyReader([bag]) as reader:
        counts = {c.topic: c.msgcount for c in reader.connections}
    assert counts['/strut_1/acceleration'] > 50
    assert counts['/strut_1/voltage'] > 50


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_it_ends_at_a_signal_and_says_so_to_its_pages(watch, client, number):
    """Exit code 0, and the connection is closed."""
    with urllib.request.urlopen(watch.address, timeout=10) as answer:
        assert answer.status == 200
    assert os.getpriority(os.PRIO_PROCESS, watch.popen.pid) >= 10
    assert watch.end(number) == 0
    client.wait(lambda: client.closed)


def test_a_run_with_its_page(domain, tmp_path):  # noqa: ARG001 - the domain is in the environment
    """`satvib run --watch`: the page shows the run, which is complete. Truth: the page's own first message.

    In the composition of one process; what the page hears are the same topics.
    """
    command = [
        sys.executable,
        '-m',
        'satvib_bringup.cli.main',
        'run',
        'quick_3dof',
        '--composition',
        'single',
        '--realtime',
        '--watch',
    ]
    log = tmp_path / 'run.log'
    run = subprocess.Popen(
        [*command, '--folder', str(tmp_path / 'run')],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    try:
        assert run.stdout is not None
        address = found_in(run.stdout, rb'http://127\.0\.0\.1:\d+', log)
        client = Client(address)
        client.wait(lambda: any(s['phase'] == 'CONTROL' for s in client.struts.values()))
        client.wait(lambda: client.newest['scenario'] == 'quick_3dof')
        run.wait(LIMIT)
        client.wait(lambda: client.closed)
        client.close()
    finally:
        run.kill()
        run.wait()
    assert (tmp_path / 'run' / 'report.html').is_file(), log.read_text()
