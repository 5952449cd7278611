# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A device on a pseudo-terminal, whose every byte passes through the hands of a test."""

import os
import select
import threading
import tty

import numpy as np
import pytest
from satvib_daq_bridge.back_ends.factory import make_back_end
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.protocol.framing import FrameReader
from satvib_daq_bridge.simulated.channels_from_rig import channels_of
from satvib_daq_bridge.simulated.device import Device
from satvib_daq_bridge.simulated.emulated_board import identity_of
from satvib_plant_sim.rig.rig import load_rig

RIG = load_rig('paper_3dof')
PERIOD, LIFETIME = 0.005, 0.02


class Bench:
    """A device on a pseudo-terminal, served by a thread until the back end is open, then by hand."""

    def __init__(self, **changes):
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        os.set_blocking(self.master, False)
        self.path = os.ttyname(self.slave)
        self.device = Device(identity_of(RIG))
        self.now = 1000
        options = changes.pop('options', {'patience': 2.0})
        data = channels_of(RIG, 'serial', self.path, options, **changes)
        self.back_end = make_back_end(parse_channels(data, 'test'), PERIOD, LIFETIME)
        self.heard = FrameReader()

    def open(self):
        over = threading.Event()
        server = threading.Thread(target=self._serve, args=(over,))
        server.start()
        try:
            found = self.back_end.open()
            self.back_end.start(self.now / 1e6)
        finally:
            over.set()
            server.join()
        return found

    def _serve(self, over):
        while not over.is_set():
            self.to_device()

    def from_host(self):
        """All that the host has written; the kernel hands it on a moment later."""
        found, patience = b'', 0.05
        while select.select([self.master], [], [], patience)[0]:
            found += os.read(self.master, 65536)
            patience = 0.001
        return found

    def to_device(self):
        self.to_host(self.device.receive(self.from_host(), self.now))

    def to_host(self, data):
        """Write what the line takes; gives the rest."""
        try:
            return data[os.write(self.master, data) :] if data else b''
        except BlockingIOError:
            return data

    def sample(self, volts=2.5):
        """The device's next sample, as bytes."""
        self.now += round(PERIOD * 1e6)
        return self.device.take_sample((round(volts * 1e6),) * 6, self.now)

    def poll(self, late=0.0):
        """All that the device has written."""
        found, patience = [], 0.05
        while select.select([self.back_end.fileno()], [], [], patience)[0]:
            found += self.back_end.poll(self.now / 1e6 + 0.001 + late)
            patience = 0.001
        return found

    def write(self, volts, sequence, enable=True):
        self.back_end.write(np.array(volts), sequence, enable, 0.0)

    def close(self):
        self.back_end.close()
        for fd in (self.master, self.slave):
            if fd >= 0:
                os.close(fd)


@pytest.fixture
def bench():
    made = Bench()
    made.open()
    yield made
    made.close()


@pytest.fixture
def new_bench():
    """The class, for tests that open a bench in their own way."""
    return Bench
