# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Machines on a switch, as Linux network namespaces joined by veth: real sockets of the kernel, no simulator.

Each machine has its own interfaces, host name and shared memory, so that Fast DDS takes it for another machine. A
program that uses them first calls `enter`, which starts it again in namespaces of its own: no right of an administrator
is needed, no interface of this machine is touched, and all ends with the program.
"""

import os
import shutil
import subprocess
import sys

_INSIDE = 'SATVIB_IN_NAMESPACES'
_READY = (
    'hostname "$1" && mount -t tmpfs none /dev/shm && ip link set lo up && echo ready && exec cat'
)
_NETWORK = '10.77.0'


def missing() -> str:
    """Why machines cannot be made here, in words; empty: they can."""
    for program, package in (('unshare', 'util-linux'), ('ip', 'iproute2')):
        if shutil.which(program) is None:
            return f'{program} is missing: apt install {package}'
    trial = 'mount -t tmpfs none /mnt && ip link add satvib0 type veth peer name satvib1'
    words = ['unshare', '-Urnm', 'sh', '-c', trial]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    said = done.stderr.strip().splitlines()
    return f'this machine lets no user make network namespaces: {said[-1]}' if said else ''


def enter() -> None:
    """Start this program again in namespaces of its own; returns there only."""
    if os.environ.get(_INSIDE) == '1':
        return
    if why := missing():
        sys.exit(why)
    os.environ[_INSIDE] = '1'
    os.execvp('unshare', ['unshare', '-Urnm', sys.executable, *sys.argv])


def run(*words: str) -> None:
    """Run a program of the network.

    Raises:
        RuntimeError: with what it said.
    """
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f'{" ".join(words)}: {done.stderr.strip()}')


class Machine:
    """A machine at a port of the switch.

    Attributes:
        name: of the host.
        address: IPv4.
    """

    def __init__(self, name: str, number: int) -> None:
        self.name, self.address = name, f'{_NETWORK}.{number}'
        self._port = f'port{number}'
        words = ['unshare', '-nmu', 'sh', '-c', _READY, 'sh', name]
        self._anchor = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert self._anchor.stdout is not None
        if self._anchor.stdout.readline() != b'ready\n':
            raise RuntimeError(f'{name}: the machine does not start')
        pid = str(self._anchor.pid)
        run('ip', 'link', 'add', self._port, 'type', 'veth', 'peer', 'name', 'eth0', 'netns', pid)
        run('ip', 'link', 'set', self._port, 'master', 'switch', 'up')
        run(*self.on('ip', 'address', 'add', f'{self.address}/24', 'dev', 'eth0'))
        run(*self.on('ip', 'link', 'set', 'eth0', 'up'))
        # where multicast goes
        run(*self.on('ip', 'route', 'add', 'default', 'dev', 'eth0'))

    def on(self, *words: str) -> list[str]:
        """Give the words that run a program on this machine."""
        return ['nsenter', '-t', str(self._anchor.pid), '-n', '-m', '-u', '--', *words]

    def cable(self, plugged: bool) -> None:
        """Plug the cable in, or pull it."""
        run('ip', 'link', 'set', self._port, 'up' if plugged else 'down')

    def lose(self, share: float) -> None:
        """Lose a share of all frames from and to this machine, at random.

        The kernel's emulator of networks (netem) is a module that many kernels lack. A classic BPF filter is part of
        all: it draws a number of 32 bits and drops the frame when it is small.
        """
        drop = round(share * 2**32)
        code = f'4,32 0 0 4294963256,53 0 1 {drop},6 0 0 4294967295,6 0 0 2'
        run('tc', 'qdisc', 'add', 'dev', self._port, 'clsact')
        for way in ('ingress', 'egress'):
            run(
                'tc',
                'filter',
                'add',
                'dev',
                self._port,
                way,
                'bpf',
                'direct-action',
                'bytecode',
                code,
            )

    def lose_nothing(self) -> None:
        """End that."""
        run('tc', 'qdisc', 'del', 'dev', self._port, 'clsact')

    def close(self) -> None:
        """Switch it off."""
        assert self._anchor.stdin is not None
        self._anchor.stdin.close()
        self._anchor.wait()


class Network:
    """A switch with machines, as a context manager; call `enter` before."""

    def __init__(self, *names: str) -> None:
        run('ip', 'link', 'add', 'switch', 'type', 'bridge')
        run('ip', 'link', 'set', 'switch', 'up')
        self.machines = [Machine(name, number) for number, name in enumerate(names, start=1)]

    def __enter__(self) -> list[Machine]:
        return self.machines

    def __exit__(self, *_: object) -> None:
        for machine in self.machines:
            machine.close()
        run('ip', 'link', 'del', 'switch')
