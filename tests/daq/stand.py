# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A stand for the real daq_bridge: an emulator on a pseudo-terminal, real processes, real DDS."""

import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import yaml

HERE = Path(__file__).parent
LIMIT = 60.0  # s, for anything that happens within a second on a machine of its own
# what a busy machine does, and a killed publisher that is still announced
FORGIVEN = ('stale', 'missed', 'no sample', 'publishers')


def _ahead_of_others():
    """Where that is permitted: the stand shares its machine with other tests."""
    with contextlib.suppress(OSError):
        os.setpriority(os.PRIO_PROCESS, 0, -15)


class Stand:
    """Processes around one bridge, and an ear on its diagnostics.

    Args:
        folder: for channels, port and logs.
        priority: SCHED_FIFO priority of every process; 0: the ordinary scheduler.
    """

    def __init__(self, folder, priority=0):
        self.folder, self.priority = folder, priority
        self.port = folder / 'port'
        self.log = folder / 'terminals.jsonl'
        self.channels = folder / 'channels.yaml'
        self.children = {}
        self.states = []
        self.latest = {}
        self._reported = None
        self.node = None

    # ---- processes

    def start(self, name, command):
        sink = (self.folder / f'{name}.log').open('ab')
        environment = {
            **os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, sys.path)),
            'PYTHONUNBUFFERED': '1', 'OPENBLAS_NUM_THREADS': '1',
        }  # fmt: skip
        child = subprocess.Popen(
            [sys.executable, *map(str, command)],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE if name == 'emulator' else sink,
            stderr=sink, env=environment, start_new_session=True, preexec_fn=_ahead_of_others,
        )  # fmt: skip
        sink.close()
        self.children[name] = child
        return child

    def start_emulator(self, *arguments, rig='paper_3dof'):
        child = self.start(
            'emulator',
            ['-m', 'satvib_daq_bridge.simulated.emulator', '--rig', rig, '--link', self.port, '--log', self.log,
             *arguments],
        )  # fmt: skip
        assert select.select([child.stdout], [], [], LIMIT)[0], self.said('emulator')
        assert child.stdout.readline().startswith(b'ready'), self.said('emulator')

    def write_channels(self, rig='paper_3dof', overrides=None, **changes):
        from satvib_daq_bridge.simulated.channels_from_rig import channels_of
        from satvib_plant_sim.rig.rig import load_rig

        changes = {'back_end': 'serial', 'device': str(self.port), **changes}
        self.channels.write_text(yaml.safe_dump(channels_of(load_rig(rig, overrides), **changes)))

    def start_bridge(self, **parameters):
        parameters = {
            'channels': str(self.channels),
            'sample_rate': 100.0,
            'command_timeout': 0.05,
            **parameters,
        }
        given = [x for k, v in parameters.items() for x in ('-p', f'{k}:={json.dumps(v)}')]
        return self.start(
            'bridge', ['-m', 'satvib_daq_bridge.nodes.daq_bridge_node', '--ros-args', *given]
        )

    def start_answerers(self, voltage=1.0):
        self.start('answerer_1', [HERE / 'answerer.py', voltage, 'strut_1'])
        self.start('answerer_2', [HERE / 'answerer.py', voltage, 'strut_2', 'strut_3'])

    def hurry(self):
        """Put every process that runs now under SCHED_FIFO, when the stand was asked to: their starting is over."""
        if not self.priority:
            return
        pids = [child.pid for child in self.children.values()]
        if 'bridge' in self.children:
            pids.append(self.guardian())
        for pid in pids:
            for task in Path(f'/proc/{pid}/task').iterdir():
                with contextlib.suppress(OSError):
                    parameters = os.sched_param(self.priority)
                    os.sched_setscheduler(int(task.name), os.SCHED_FIFO, parameters)

    def guardian(self):
        """The guardian's process id: the bridge's only child."""
        pid = self.children['bridge'].pid
        children = Path(f'/proc/{pid}/task/{pid}/children').read_text().split()
        (found,) = [int(c) for c in children]
        return found

    def kill(self, *names):
        """SIGKILL; gives when, s of the monotonic clock."""
        pids = [self.guardian() if n == 'guardian' else self.children[n].pid for n in names]
        now = time.monotonic()
        for pid in pids:
            os.kill(pid, signal.SIGKILL)
        return now

    def end(self, *names, patience=LIMIT):
        """SIGTERM, and wait; gives the exit codes."""
        for name in names:
            with contextlib.suppress(ProcessLookupError):
                self.children[name].send_signal(signal.SIGTERM)
        return [self.children.pop(name).wait(patience) for name in names]

    def said(self, name):
        path = self.folder / f'{name}.log'
        return path.read_text() if path.exists() else ''

    def close(self):
        for child in self.children.values():
            with contextlib.suppress(ProcessLookupError):
                child.kill()
            child.wait()
        if self.node is not None:
            self._executor.shutdown(0.0)
            self.node.destroy_node()
            self._rclpy.shutdown(context=self._context)

    # ---- the graph

    def join(self):
        """Make this process a member of the graph."""
        if self.node is not None:
            return
        import rclpy
        from diagnostic_msgs.msg import DiagnosticArray
        from rclpy.context import Context
        from rclpy.executors import SingleThreadedExecutor
        from satvib_common.ros.qos import wanted

        self._rclpy, self._context = rclpy, Context()
        rclpy.init(context=self._context)
        self.node = rclpy.create_node('stand', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self.node.create_subscription(
            DiagnosticArray, '/diagnostics', self._on_diagnostics, wanted(whole=False, depth=200)
        )

    def another_node(self, name):
        """A second node of this process, which only publishes."""
        self.join()
        return self._rclpy.create_node(name, context=self._context)

    def _on_diagnostics(self, message):
        for status in message.status:
            if status.name.endswith('daq_bridge'):
                values = {v.key: v.value for v in status.values}
                self.latest.update(values, level=status.level, message=status.message)
                self._take_state((values['state'], values['reason']), change='before' in values)

    def _take_state(self, found, change):
        """A change of state; at first also a state that is reported: the change to it came before the stand did."""
        if change and found != self._reported:
            self.states.append(found)
        elif not self.states and found[0] != 'UNCONFIGURED':
            self.states.append(found)
            self._reported = found
        if change:
            self._reported = None

    def until(self, condition, what, limit=LIMIT):
        """Take part in the graph until something holds."""
        self.join()
        deadline = time.monotonic() + limit
        while not condition():
            assert time.monotonic() < deadline, f'{what}: {self.states} ' + ' '.join(
                f'{name}: {self.said(name)[-2000:]}' for name in self.children
            )
            self._executor.spin_once(0.05)

    def call(self, what):
        """Call a trigger of the bridge; gives whether it succeeded and what it said."""
        from std_srvs.srv import Trigger

        answer = self.ask(Trigger, what, Trigger.Request())
        return answer.success, answer.message

    def ask(self, kind, what, request):
        """Call a service of the bridge; gives its answer."""
        self.join()
        client = self.node.create_client(kind, f'/daq_bridge/{what}')
        self.until(client.service_is_ready, f'service {what}')
        future = client.call_async(request)
        self.until(future.done, f'answer of {what}')
        self.node.destroy_client(client)
        return future.result()

    def transition(self, label):
        """Ask for a lifecycle transition; gives whether it was made."""
        from lifecycle_msgs.msg import Transition
        from lifecycle_msgs.srv import ChangeState

        wanted = Transition(id=getattr(Transition, f'TRANSITION_{label.upper()}'), label=label)
        return self.ask(ChangeState, 'change_state', ChangeState.Request(transition=wanted)).success

    @property
    def state(self):
        return self.states[-1][0] if self.states else ''

    def until_state(self, state):
        self.until(lambda: self.state == state, f'state {state}')

    def until_armed(self):
        """Call ~/arm until the bias is learnt and it is granted; a line that a busy machine let stall is reset."""
        while True:
            granted, why = self.call('arm')
            if granted:
                return
            late = 'refused in FAULT' in why and any(word in why for word in FORGIVEN)
            if late or 'the device or its line stalls' in why:
                self.call('reset')
                continue
            assert 'not learnt yet' in why or 'not active' in why or 'publishers' in why, why
            self._executor.spin_once(0.05)

    def drive(self):
        """Arm until ACTIVE, and until there are voltages at the terminals where there are terminals.

        A busy machine may be too late at first; that is a fault, and is forgiven.
        """
        if not self.log.exists():
            self.until_armed()
            self.until_state('ACTIVE')
            return
        self.until(lambda: self.events()[-1]['event'] != 'enabled', '0 V before arming')
        self.until_armed()
        while True:
            self.until(
                lambda: self.events()[-1]['event'] == 'enabled' or self.state == 'FAULT', 'voltages'
            )
            if self.state != 'FAULT':
                return
            assert any(w in self.states[-1][1] for w in FORGIVEN), self.states
            self.call('reset')
            self.until_state('IDLE')
            self.until_armed()

    # ---- the terminals

    def events(self):
        found = [json.loads(line) for line in self.log.read_text().splitlines()]
        return found or [{'event': 'none', 't': 0.0}]

    def zero_after(self, moment):
        """When the terminals went to 0 V after a moment, s after it, and why."""
        deadline = time.monotonic() + LIMIT
        while time.monotonic() < deadline:
            for event in self.events():
                if event['event'] == 'zero' and event['t'] >= moment:
                    return event['t'] - moment, event['why']
            select.select([], [], [], 0.01)
        raise AssertionError('the terminals never went to 0 V')
