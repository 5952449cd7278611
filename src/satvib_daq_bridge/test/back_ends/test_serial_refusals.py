# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the serial back end refuses, by name and in one line.

Truth: the rules of docs/serial_protocol.md.
"""

import pytest
from satvib_common.errors import SatvibError
from satvib_daq_bridge.back_ends.factory import make_back_end
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.simulated.channels_from_rig import channels_of
from satvib_plant_sim.rig.rig import load_rig

RIG = load_rig('paper_3dof')
PERIOD, LIFETIME = 0.005, 0.02


def test_nobody_there_is_said_in_one_line(new_bench):
    data = channels_of(RIG, 'serial', '/dev/nowhere')
    absent = make_back_end(parse_channels(data, 'test'), PERIOD, LIFETIME)
    with pytest.raises(SatvibError, match='/dev/nowhere: the port cannot be opened'):
        absent.open()
    mute = new_bench(options={'patience': 0.3})
    with pytest.raises(SatvibError, match=r'no satvib device answers within 0\.3 s'):
        mute.back_end.open()
    mute.close()


@pytest.mark.parametrize(
    ('changes', 'message'),
    [
        ({'sensor': {'range': [-10.0, 10.0]}}, r'strut_1\.upper\.range: -10 to 10 V, but the device'),
        ({'coil': {'range': [-5.0, 5.0], 'limit': 5.0}}, r'strut_1\.coil\.range: -5 to 5 V, but'),
    ],
)  # fmt: skip
def test_a_device_with_other_ranges_is_refused_by_name(changes, message, new_bench):
    made = new_bench(**changes)
    with pytest.raises(SatvibError, match=message):
        made.open()
    made.close()


def test_a_port_in_use_is_refused(bench):
    data = channels_of(RIG, 'serial', bench.path)
    with pytest.raises(SatvibError, match='the port cannot be opened'):
        make_back_end(parse_channels(data, 'test'), PERIOD, LIFETIME).open()


def test_a_rate_that_the_device_cannot_do_is_refused(new_bench):
    made = new_bench()
    made.back_end.period = 1e-4
    with pytest.raises(SatvibError, match=r'refuses the set-up \(period\)'):
        made.open()
    made.close()


def test_options_are_checked():
    data = channels_of(RIG, 'serial', '/dev/x', {'hold': 'cubic'})
    with pytest.raises(SatvibError, match=r'test: options: hold: .cubic. is not one of'):
        make_back_end(parse_channels(data, 'test'), PERIOD, LIFETIME)
