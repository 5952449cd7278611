# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The launch files with the real `ros2 launch`, where there is one (an installed ROS 2; the wheels have none)."""

import os
import re
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pytest
import yaml

LAUNCH = shutil.which('ros2') and subprocess.run(
    ['ros2', 'launch', '--help'], capture_output=True, check=False
)
pytestmark = pytest.mark.skipif(
    not LAUNCH or LAUNCH.returncode != 0,
    reason='there is no `ros2 launch` here; an installed ROS 2 has it',
)


@pytest.fixture
def launch(domain, tmp_path, monkeypatch):  # noqa: ARG001
    """Start a launch file in an empty folder; at the end nothing of it may be left."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv('TMPDIR', str(tmp_path / 'temporary'))
    (tmp_path / 'temporary').mkdir()
    monkeypatch.setattr(tempfile, 'tempdir', None)
    started = []

    def begin(name, **arguments):
        words = [f'{key}:={value}' for key, value in arguments.items()]
        process = subprocess.Popen(
            ['ros2', 'launch', '--noninteractive', 'satvib_bringup', f'{name}.launch.py', *words],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True,
        )  # fmt: skip
        started.append(process)
        return process

    yield begin
    for process in started:
        left = _session(process.pid)
        if left:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait(60.0)
        assert not left, 'processes were left running'
    assert list((tmp_path / 'temporary').iterdir()) == []


def _session(leader):
    """Processes of the session that the launch began."""
    found = []
    for entry in Path('/proc').iterdir():
        try:
            fields = (entry / 'stat').read_text().rpartition(')')[2].split()
        except OSError:
            continue
        if entry.name.isdecimal() and int(fields[3]) == leader and fields[0] != 'Z':
            found.append(int(entry.name))
    return found


def over(process, code=0):
    """Wait; gives what was said."""
    said, _ = process.communicate(timeout=180.0)
    assert process.returncode == code, said
    assert 'Traceback' not in said
    return said


def test_every_launch_file_shows_its_arguments():
    """Truth: the arguments of the plans."""
    from satvib_bringup.live.launching.plans import PLANS

    for name, plan in PLANS.items():
        said = subprocess.run(
            ['ros2', 'launch', 'satvib_bringup', f'{name}.launch.py', '--show-args'],
            capture_output=True, text=True, timeout=60.0, check=True,
        ).stdout  # fmt: skip
        assert re.findall(r"^ +'(\w+)':$", said, re.MULTILINE) == list(plan.arguments)


def test_simulation_is_the_run_of_the_twin(launch):
    """Truth: `simulate`, bit for bit; the bag is whole. The namespace changes names only."""
    from satvib_experiment import load_recording, load_scenario, simulate

    over(launch('simulation', scenario='quick_3dof', bag='bag', overrides='seed=7'))
    recording = load_recording(Path('bag'))
    twin = simulate(load_scenario('quick_3dof', ['seed=7']))
    np.testing.assert_array_equal(
        recording.get('voltage', 'voltage'), twin.get('voltage', 'voltage')
    )


def test_a_namespace_and_a_parameter_file(launch, probe, tmp_path):
    """Truth: the topics are below the namespace, and the limit of the file is seen in the voltages: 2 V and not 10."""
    from satvib_msgs.msg import VcaVoltage

    found = probe.collect(VcaVoltage, '/rig_a/strut_2/voltage')
    limits = {'voltage_limit': 2.0, 'excitation_amplitude': 2.0}
    (tmp_path / 'p.yaml').write_text(
        yaml.safe_dump({'/rig_a/strut_2/strut_controller': {'ros__parameters': limits}})
    )
    process = launch(
        'simulation', scenario='quick_3dof', namespace='rig_a', params_file='p.yaml', composition='separate',
        log_level='warn',
    )  # fmt: skip
    probe.wait(lambda: found and found[-1].sequence == 399)
    over(process)
    assert max(abs(v.voltage) for v in found) == 2.0


def test_centralized(launch):
    said = over(launch('centralized', overrides='duration=13.0 analysis={}'))
    assert 'plant_sim: 1300 samples of 3 struts' in said


def test_single(launch):
    over(launch('simulation', scenario='quick_3dof', composition='single', bag='bag'))
    assert Path('bag/metadata.yaml').is_file()


def test_hardware(launch, probe, tmp_path):
    """A simulated device behind the real bridge. Truth: once armed, it plays the schedule to its end."""
    from satvib_daq_bridge.simulated.channels_from_rig import channels_of
    from std_srvs.srv import Trigger

    from satvib_plant_sim import load_rig

    channels = channels_of(load_rig('paper_3dof'), 'loopback', options={'pace': 'realtime'})
    (tmp_path / 'channels.yaml').write_text(yaml.safe_dump(channels))
    process = launch('hardware', channels='channels.yaml', scenario='quick_3dof', record='true')
    probe.wait(lambda: probe.call(Trigger, '/daq_bridge/arm', Trigger.Request()).success)
    over(process)
    (bag,) = tmp_path.glob('satvib-*')
    assert (bag / 'metadata.yaml').is_file()


def test_one_strut_and_a_recorder_end_with_ctrl_c(launch, probe):
    """Truth: their nodes are there, and one SIGINT to the launch ends them all well."""
    ours = {'strut_controller', 'strut_identifier', 'recorder'}
    processes = [launch('strut', strut='strut_2'), launch('record', bag='bag', struts='strut_2')]
    probe.wait(lambda: ours <= set(probe.node.get_node_names()))
    for process in processes:
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
    for process in processes:
        said = over(process)
        assert 'process has died' not in said
    assert Path('bag/metadata.yaml').is_file()


def test_replay(launch, tmp_path):
    """Truth: every sample of the record is identified, and the launch ends by itself."""
    from satvib_experiment import load_recording

    draw = np.random.default_rng(1)
    u = draw.standard_normal(300)
    y = np.convolve(u, [0.5, 0.25])[:300]
    np.savetxt(
        tmp_path / 'r.csv', np.column_stack((u, y)), delimiter=',', header='u,y', comments=''
    )
    said = over(launch('replay', file='r.csv', input='u', output='y', bag='bag'))
    assert 'recorder' in said
    assert load_recording(Path('bag')).get('model', 'a').shape[0] >= 1


@pytest.mark.parametrize(
    'victim', ['recorder', 'strut_2/strut_identifier', 'plant_sim', 'schedule']
)
def test_the_end_of_any_member_ends_the_launch(launch, probe, victim):
    """Truth: exit code 1, and the member that ended is named."""
    from satvib_msgs.msg import VcaVoltage

    found = probe.collect(VcaVoltage, '/strut_2/voltage')
    process = launch('simulation', bag='bag', realtime='true')
    probe.wait(lambda: len(found) > 20)
    name = victim.rpartition('/')[2]
    strut = '/strut_2' if '/' in victim else None
    (pid,) = [
        p for p in _session(process.pid)
        if f'/{name}' in (words := Path(f'/proc/{p}/cmdline').read_text()) and 'launch' not in words
        and (strut is None or f'__ns:={strut}' in words)
    ]  # fmt: skip
    os.kill(pid, signal.SIGKILL)
    said = over(process, code=1)
    assert f'{victim} was killed by SIGKILL, and so does the launch' in said
