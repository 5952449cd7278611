# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The faults of the suite, once: what happens, where, what must become of the voltage, and within which time.

The tests play this list, `benchmarks/faults.py` plays it several times, and the table in docs/faults.md is made of it.
"""

import math
from enum import Enum
from typing import NamedTuple

from mangling import Mangling

RATE = 200  # Hz


class Must(Enum):
    """What must become of the voltage."""

    STEADY = 'the law goes on acting, the payload stays as calm'
    BOUNDED = 'no voltage beyond the guard, then as calm as before'
    ZERO = '0 V, then it goes on by itself'
    LATCHED = '0 V until `~/reset`, then it goes on'
    ENDS = 'the plant ends with exit code 1 and says why, the bag is whole'


class Mangle(NamedTuple):
    """The fault node changes `count` messages of a topic between two nodes."""

    topic: str
    mangling: Mangling
    count: int = RATE // 2


class Stranger(NamedTuple):
    """Another node publishes on a topic what it has heard there, changed."""

    topic: str
    kind: str
    mangling: Mangling
    count: int
    rate: float
    readers: int  # at least so many hear it before it begins


class Stall(NamedTuple):
    """SIGSTOP, and SIGCONT after so many samples beyond the command timeout."""

    node: str
    samples: int


class Restart(NamedTuple):
    """SIGKILL, and another process of the same node."""

    node: str


class Second(NamedTuple):
    """A second process of a node beside the first, until 0 V is latched."""

    node: str


Act = Mangle | Stranger | Stall | Restart | Second


class Fault(NamedTuple):
    """A fault.

    Attributes:
        name: of the fault, and of its row.
        act: what is done.
        must: what must become of the voltage.
        within: samples from the fault to 0 V, where 0 V is asked for; beyond the command timeout if `silence`.
        back: samples from the end of the fault until the payload is as calm as before.
        silence: the fault is found because no fresh voltage comes.
        said: a part of what some node must have said.
    """

    name: str
    act: Act
    must: Must
    within: int = 0
    back: int = 2 * RATE
    silence: bool = False
    said: str = ''


HUGE = [math.nan, math.inf, -math.inf, 1e300, -1e300]
FAR = [2**63, 2**64 - 1, 10**9, 0]
HOUR = 3600

MESSAGES = (
    Fault('voltages lost, every third', Mangle('voltage', Mangling('lose', 0.33)), Must.BOUNDED),
    Fault('voltages doubled, one in twenty', Mangle('voltage', Mangling('double', 0.05)), Must.STEADY),
    Fault(
        'every voltage doubled', Mangle('voltage', Mangling('double')), Must.LATCHED, 25, said='two controllers answer',
    ),
    Fault('voltages reordered, one pair in twenty', Mangle('voltage', Mangling('swap', 0.05)), Must.STEADY),
    Fault(
        'voltages reordered, every second pair', Mangle('voltage', Mangling('swap'), RATE), Must.LATCHED, 120,
        said='two controllers answer',
    ),
    Fault('voltages delayed by 4 samples', Mangle('voltage', Mangling('delay', by=4)), Must.BOUNDED),
    Fault(
        'all voltages lost', Mangle('voltage', Mangling('lose'), 2 * RATE), Must.ZERO, 3, silence=True,
        said='no fresh voltage',
    ),
    Fault('accelerations lost, every third', Mangle('acceleration', Mangling('lose', 0.33)), Must.BOUNDED),
    Fault(
        'accelerations doubled, one in twenty', Mangle('acceleration', Mangling('double', 0.05)), Must.STEADY,
    ),
    Fault(
        'every acceleration doubled', Mangle('acceleration', Mangling('double')), Must.LATCHED, 30,
        said='two sources of samples',
    ),
    Fault(
        'accelerations reordered, one pair in twenty', Mangle('acceleration', Mangling('swap', 0.05)), Must.BOUNDED,
    ),
    Fault('accelerations delayed by 4 samples', Mangle('acceleration', Mangling('delay', by=4)), Must.BOUNDED),
    Fault(
        'accelerations with NaN, inf, 1e300, one in ten',
        Mangle('acceleration', Mangling(share=0.1, put={'upper': HUGE})), Must.BOUNDED,
    ),
    Fault(
        'accelerations with an absurd sequence, one in ten',
        Mangle('acceleration', Mangling(share=0.1, put={'sequence': FAR})), Must.BOUNDED,
    ),
    Fault(
        'voltages with an absurd sequence, one in ten',
        Mangle('voltage', Mangling(share=0.1, put={'sequence': FAR})), Must.BOUNDED,
    ),
    Fault(
        'a voltage that is no number', Mangle('voltage', Mangling(put={'voltage': math.nan}), 1), Must.LATCHED, 2,
        said='the voltage of sample',
    ),
    Fault(
        'voltages of 1e300 V, one in ten', Mangle('voltage', Mangling(share=0.1, put={'voltage': [1e300, -1e300]})),
        Must.BOUNDED,
    ),
)  # fmt: skip

LONG = 5 * RATE  # samples in which the vibration watch listens, and the law comes back
SENSORS = (
    Fault('the upper sensor is stuck', Mangle('acceleration', Mangling(hold=('upper',))), Must.BOUNDED),
    Fault(
        'the upper sensor stands at the end of its range, marked',
        Mangle('acceleration', Mangling(put={'upper': 39.2, 'upper_clipped': True})), Must.BOUNDED, back=LONG,
    ),
    Fault(
        'the upper sensor stands at the end of its range, not marked',
        Mangle('acceleration', Mangling(put={'upper': 39.2})), Must.BOUNDED, back=LONG,
    ),
    Fault(
        'the upper sensor drifts by 10 m/s^2 in a second',
        Mangle('acceleration', Mangling(slope={'upper': 0.05})), Must.BOUNDED, back=LONG,
    ),
    Fault(
        'a step of bias of 5 m/s^2', Mangle('acceleration', Mangling(add={'upper': 5.0})), Must.BOUNDED, back=LONG,
    ),
)  # fmt: skip

CLOCKS = tuple(
    Fault(
        f'the clock steps {word} by an hour, as the stamps say',
        Mangle('acceleration', Mangling(add={'header.stamp.sec': step})), Must.STEADY,
    )
    for word, step in (('forward', HOUR), ('back', -HOUR))
)  # fmt: skip


def _stranger(topic: str, mangling: Mangling, count: int = 500, rate: float = 1000.0) -> Stranger:
    kind, name, readers = {
        'voltage': ('VcaVoltage', '/strut_1/voltage', 2),
        'acceleration': ('StrutAcceleration', '/strut_1/acceleration', 2),
        'model': ('IirParameters', '/strut_1/identified_model', 1),
        'state': ('ControllerState', '/strut_1/controller_state', 1),
        'schedule': ('Schedule', '/schedule', 3),
    }[topic]
    return Stranger(name, f'satvib_msgs/{kind}', mangling, count, rate, readers)


STRANGERS = (
    Fault(
        'a stranger: voltages that are no numbers', _stranger('voltage', Mangling(put={'voltage': HUGE}), 10),
        Must.STEADY,
    ),
    Fault(
        'a stranger: accelerations at 1 kHz, repeated', _stranger('acceleration', Mangling()), Must.LATCHED, 60,
        said='two sources of samples',
    ),
    Fault(
        'a stranger: accelerations at 1 kHz with an absurd sequence',
        _stranger('acceleration', Mangling(put={'sequence': FAR})), Must.LATCHED, 60, said='two sources of samples',
    ),
    Fault(
        'a stranger: another plan, at 1 kHz', _stranger('schedule', Mangling(put={'end_sequence': 1})), Must.BOUNDED,
        said='refused: schedule',
    ),
    Fault(
        'a stranger: a plan with an unknown phase',
        _stranger('schedule', Mangling(put={'phases': [[9]], 'first_sequence': [[0]]}), 5), Must.STEADY,
        said='refused: schedule',
    ),
    Fault(
        'a stranger: a model that is no number',
        _stranger('model', Mangling(put={'a': [[math.nan]], 'b': [[math.nan]]}), 5), Must.STEADY,
    ),
    Fault(
        'a stranger: a model of another sample period',
        _stranger('model', Mangling(put={'sample_period': 1.0}), 5), Must.STEADY,
    ),
    Fault('a stranger: states at 1 kHz', _stranger('state', Mangling(put={'voltage': 1e300})), Must.BOUNDED),
)  # fmt: skip

PROCESSES = (
    Fault('SIGSTOP of the controller', Stall('controller', 40), Must.ZERO, 3, silence=True),
    Fault('SIGKILL of the controller, started again', Restart('controller'), Must.ZERO, 3, silence=True),
    Fault('SIGSTOP of the identifier', Stall('identifier', 40), Must.STEADY),
    Fault('SIGKILL of the identifier, started again', Restart('identifier'), Must.STEADY),
    Fault('a second controller', Second('controller'), Must.LATCHED, 150, said='two controllers answer'),
)  # fmt: skip

# each needs a graph of its own, and is played last
ENDINGS = (
    Fault(
        'a stranger: voltages at 1 kHz for samples that are not there yet',
        _stranger('voltage', Mangling(add={'sequence': 1000})), Must.ENDS, said='another source of samples is running',
    ),
)  # fmt: skip

GOES_ON = (*MESSAGES, *SENSORS, *CLOCKS, *STRANGERS, *PROCESSES)
# heading: faults
CHAPTERS = {
    'Messages on their way': MESSAGES,
    'Sensors': SENSORS,
    'Clocks': CLOCKS,
    'Strangers': STRANGERS,
    'Processes': PROCESSES,
    'Faults that end the graph': ENDINGS,
}


class Elsewhere(NamedTuple):
    """A fault that has a test of its own: in words what must happen, and the test."""

    name: str
    must: str
    test: str


OTHERS = (
    Elsewhere(
        'SIGKILL of plant, controller, identifier or recorder in a run',
        'the run ends within 3 s, by name, and the bag is read',
        'tests/faults/test_run_live.py::test_killing_a_node_ends_the_run',
    ),
    Elsewhere(
        'SIGKILL of the runner',
        'every node ends, and the bag is read',
        'tests/faults/test_run_live.py::test_killing_the_runner_leaves_no_process',
    ),
    Elsewhere(
        'a voltage that is no number, in lockstep',
        'the run ends by name',
        'tests/faults/test_run_live.py::test_not_a_number_on_the_voltage_topic',
    ),
    Elsewhere(
        'a second run in the same domain',
        'refused by name',
        'tests/faults/test_run_live.py::test_two_graphs_do_not_share_a_domain',
    ),
    Elsewhere(
        'SIGSTOP of the controller with `after_silence: latch`',
        '0 V until `~/reset`',
        'tests/faults/test_restart_live.py::test_after_latch_only_reset_helps',
    ),
    Elsewhere(
        'restart of the controller in CALIBRATE, IDENTIFY, CONTROL',
        'after a second the voltage of a controller that was never away',
        'tests/faults/test_restart_live.py::test_a_controller_that_is_started_again_goes_on',
    ),
    Elsewhere(
        'restart of the identifier in IDENTIFY and CONTROL',
        'no voltage is withheld, and the bias stays',
        'tests/faults/test_restart_live.py::test_an_identifier_that_is_started_again_harms_nothing',
    ),
    Elsewhere(
        'restart of the plant',
        'the run begins again with sample 0',
        'tests/faults/test_restart_live.py::test_a_plant_that_is_started_again_begins_the_run_again',
    ),
    Elsewhere(
        'the disk is full before a run',
        'one line, exit code 2',
        'tests/faults/test_full_disk_live.py::test_a_full_disk_is_one_line',
    ),
    Elsewhere(
        'the disk fills while a bag is written',
        'the bag ends whole',
        'tests/faults/test_full_disk_live.py::test_a_recording_ends_whole_before_the_disk_is_full',
    ),
    Elsewhere(
        'the disk fills in a run',
        'the run ends by name, and the bag is read',
        'tests/faults/test_full_disk_live.py::test_a_disk_that_fills_during_a_run_ends_it_and_loses_little',
    ),
    Elsewhere(
        'SIGKILL of bridge, guardian, controller or all, on hardware',
        '0 V at the terminals',
        'tests/daq/test_daq_live.py::test_kill_9',
    ),
    Elsewhere(
        'SIGSTOP of bridge or guardian, on hardware',
        '0 V at the terminals, FAULT',
        'tests/daq/test_daq_live.py::test_a_process_that_hangs_is_0_v_too',
    ),
    Elsewhere(
        'the device is unplugged',
        'FAULT; it goes on after `~/reset`',
        'tests/daq/test_daq_live.py::test_an_unplugged_device_and_its_return',
    ),
    Elsewhere(
        'a second publisher of voltages, on hardware',
        'FAULT, by name',
        'tests/daq/test_daq_live.py::test_a_second_publisher_is_refused',
    ),
)  # fmt: skip
