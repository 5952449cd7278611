# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The faults of the suite, once: what happens, where, what must become of the voltage, and within which time.

The tests play this list, `benchmarks/faults.py` plays it several times, and the table in docs/faults.md is made of it.
"""

import math
from enum import Enum
from typing import NamedTuple

from mangling import Mangling
from satvib_common.phases import Phase

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
    """Another node publishes on a topic what it has heard there, changed; or a message that is blank but for that."""

    topic: str
    kind: str
    mangling: Mangling
    count: int
    rate: float
    readers: int  # at least so many hear it before it begins
    blank: bool = False


class Stall(NamedTuple):
    """SIGSTOP, and SIGCONT after so many samples beyond the command timeout."""

    node: str
    samples: int


class Restart(NamedTuple):
    """SIGKILL, and another process of the same node."""

    node: str


class Second(NamedTuple):
    """A second process of a node beside the first, until one of the graph says so."""

    node: str


Act = Mangle | Stranger | Stall | Restart | Second
IN_CONTROL = (Phase.CONTROL,)
IN_EACH = (Phase.STANDBY, Phase.CALIBRATE, Phase.IDENTIFY, Phase.CONTROL)


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
        phases: in which it is played.
        louder: dB, by which the payload may be louder meanwhile where the law must go on acting.
    """

    name: str
    act: Act
    must: Must
    within: int = 0
    back: int = 2 * RATE
    silence: bool = False
    said: str = ''
    phases: tuple[Phase, ...] = IN_CONTROL
    louder: float = 2.0


HUGE = [math.nan, math.inf, -math.inf, 1e300, -1e300]
FAR = [2**63, 2**64 - 1, 10**9, 0]
ABSURD = {
    'applied': HUGE,
    'applied_state': [7, 255],
    'pace': [2, 255],
    'sample_period': [0.005, -1.0],
}
HOUR = 3600

MESSAGES = (
    # a voltage is then half a sample older on average, which costs 0.6 dB at most; see docs/faults.md
    Fault('voltages lost, every third', Mangle('voltage', Mangling('lose', 0.33)), Must.STEADY),
    Fault('voltages doubled, one in twenty', Mangle('voltage', Mangling('double', 0.05)), Must.STEADY),
    Fault(
        'every voltage doubled', Mangle('voltage', Mangling('double')), Must.LATCHED, 25,
        said='/between publishes each twice',
    ),
    Fault('voltages reordered, one pair in twenty', Mangle('voltage', Mangling('swap', 0.05)), Must.STEADY),
    Fault(
        'voltages reordered, every second pair', Mangle('voltage', Mangling('swap'), RATE), Must.LATCHED, 120,
        said='/between publishes each twice or out of order',
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
        said='samples as of two sources: /between publishes each twice',
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
        'accelerations whose other numbers are absurd, one in ten',
        Mangle('acceleration', Mangling(share=0.1, put=ABSURD)), Must.BOUNDED,
    ),
    Fault(
        'accelerations cut off, one in ten', Mangle('acceleration', Mangling(share=0.1, damage='cut')), Must.BOUNDED,
        said='refused: /strut_1/acceleration',
    ),
    Fault(
        'accelerations with a wrong bit, one in ten', Mangle('acceleration', Mangling(share=0.1, damage='flip')),
        Must.BOUNDED, back=5 * RATE,
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
    Fault(
        'voltages cut off, one in ten', Mangle('voltage', Mangling(share=0.1, damage='cut')), Must.BOUNDED,
        said='refused: /plant/strut_1/voltage',
    ),
)  # fmt: skip


def _models(
    word: str, mangling: Mangling, must: Must = Must.STEADY, within: int = 0, said: str = ''
) -> Fault:
    """In IDENTIFY, where a model comes with every sample."""
    act, phases = Mangle('identified_model', mangling), (Phase.IDENTIFY,)
    return Fault(f'models {word}', act, must, within, said=said, phases=phases)


NO_MODEL = {'a': [[math.nan]], 'b': [[1e300]], 'covariance': [[math.inf] * 4]}
MODELS = (
    _models('lost, all', Mangling('lose')),
    _models('doubled, one in twenty', Mangling('double', 0.05)),
    _models(
        'doubled, all', Mangling('double'), Must.LATCHED, 40, 'models as of two sources: /between'
    ),
    _models('reordered, one pair in twenty', Mangling('swap', 0.05)),
    _models('delayed by 4 samples', Mangling('delay', by=4)),
    _models('that are no numbers, one in ten', Mangling(share=0.1, put=NO_MODEL)),
    _models('with an absurd sequence, one in twenty', Mangling(share=0.05, put={'sequence': FAR})),
    _models('cut off, one in ten', Mangling(share=0.1, damage='cut')),
    _models('with a wrong bit, one in ten', Mangling(share=0.1, damage='flip')),
)

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
    Fault(
        'the lower sensor is stuck, at the end of its range, or no number',
        Mangle('acceleration', Mangling(put={'lower': [3.0, 39.2, math.nan]})), Must.STEADY,
    ),
)  # fmt: skip

CLOCKS = tuple(
    Fault(
        f'the clock steps {word} by an hour, as the stamps say',
        Mangle('acceleration', Mangling(add={'header.stamp.sec': step})), Must.STEADY,
    )
    for word, step in (('forward', HOUR), ('back', -HOUR))
)  # fmt: skip

# topic: kind of its messages, name, readers besides the stranger, and whether nobody else may have spoken there
TOPICS = {
    'voltage': ('satvib_msgs/VcaVoltage', '/strut_1/voltage', 2, False),
    # past the fault node, which is slower than a flood and leaves out what cannot be read
    'voltage at the plant': ('satvib_msgs/VcaVoltage', '/plant/strut_1/voltage', 1, False),
    'acceleration': ('satvib_msgs/StrutAcceleration', '/strut_1/acceleration', 2, False),
    'model': ('satvib_msgs/IirParameters', '/strut_1/identified_model', 1, False),
    'state': ('satvib_msgs/ControllerState', '/strut_1/controller_state', 1, False),
    'truth': ('satvib_msgs/StrutTruth', '/strut_1/truth', 1, False),
    'applied': ('satvib_msgs/VoltageApplied', '/strut_1/voltage_applied', 0, True),
    'schedule': ('satvib_msgs/Schedule', '/schedule', 3, False),
    'supervision': ('std_msgs/UInt64', '/supervision', 0, True),
    'clock': ('rosgraph_msgs/Clock', '/clock', 0, True),
    'diagnostics': ('diagnostic_msgs/DiagnosticArray', '/diagnostics', 1, True),
}


def _stranger(topic: str, mangling: Mangling, count: int = 500, rate: float = 1000.0) -> Stranger:
    kind, name, readers, blank = TOPICS[topic]
    return Stranger(name, kind, mangling, count, rate, readers, blank)


TWO_SOURCES = 'two sources of samples'
STRANGERS = (
    Fault(
        'a stranger: voltages of NaN and 1e300 V, for answered samples',
        _stranger('voltage', Mangling(put={'voltage': HUGE}), 10),
        Must.STEADY,
    ),
    Fault(
        'a stranger: 20 V at 1 kHz', _stranger('voltage', Mangling(put={'voltage': 20.0})), Must.LATCHED, 60,
        said='/between publishes each twice or out of order',  # the plant hears them from there
    ),
    Fault(
        'a stranger: 20 V at 5 kHz',
        _stranger('voltage at the plant', Mangling(put={'voltage': 20.0}), 1500, 5000.0), Must.LATCHED, 60,
        said='two controllers answer',
    ),
    Fault(
        'a stranger: voltages cut off, at 1 kHz', _stranger('voltage at the plant', Mangling(damage='cut')),
        Must.BOUNDED,
        said='refused: /plant/strut_1/voltage',
    ),
    Fault(
        'a stranger: accelerations at 1 kHz, repeated', _stranger('acceleration', Mangling()), Must.LATCHED, 60,
        said=TWO_SOURCES,
    ),
    Fault(
        'a stranger: accelerations at 1 kHz with an absurd sequence',
        _stranger('acceleration', Mangling(put={'sequence': FAR})), Must.LATCHED, 60, said=TWO_SOURCES,
    ),
    Fault(
        'a stranger: accelerations at 1 kHz that count on from 10^9',
        _stranger('acceleration', Mangling(put={'sequence': 10**9}, slope={'sequence': 1})), Must.LATCHED, 60,
        said=TWO_SOURCES,
    ),
    Fault(
        'a stranger: accelerations in lockstep at 1 kHz', _stranger('acceleration', Mangling(put={'pace': 2})),
        Must.BOUNDED,
    ),
    Fault(
        'a stranger: accelerations cut off, at 1 kHz', _stranger('acceleration', Mangling(damage='cut')), Must.BOUNDED,
        said='refused: /strut_1/acceleration',
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
    Fault(
        'a stranger: models with an absurd sequence', _stranger('model', Mangling(put={'sequence': FAR}), 8),
        Must.STEADY,
    ),
    Fault(
        'a stranger: models at 1 kHz', _stranger('model', Mangling()), Must.LATCHED, 60, said='two sources of models',
    ),
    Fault('a stranger: states at 1 kHz', _stranger('state', Mangling(put={'voltage': 1e300})), Must.BOUNDED),
    Fault('a stranger: truth at 1 kHz', _stranger('truth', Mangling()), Must.BOUNDED),
    Fault('a stranger: applied voltages at 1 kHz', _stranger('applied', Mangling(put={'voltage': 20.0})), Must.BOUNDED),
    Fault(
        'a stranger: judgements of a supervisor at 1 kHz', _stranger('supervision', Mangling(put={'data': FAR})),
        Must.BOUNDED,
    ),
    Fault(
        'a stranger: a clock of another time at 1 kHz', _stranger('clock', Mangling(put={'clock.sec': 7})),
        Must.BOUNDED,
    ),
    Fault('a stranger: diagnostics at 1 kHz', _stranger('diagnostics', Mangling()), Must.BOUNDED),
)  # fmt: skip

PROCESSES = (
    Fault('SIGSTOP of the controller', Stall('controller', 40), Must.ZERO, 3, silence=True, phases=IN_EACH),
    Fault(
        'SIGKILL of the controller, started again', Restart('controller'), Must.ZERO, 3, silence=True, phases=IN_EACH,
    ),
    Fault('SIGSTOP of the identifier', Stall('identifier', 40), Must.STEADY, phases=IN_EACH),
    Fault('SIGKILL of the identifier, started again', Restart('identifier'), Must.STEADY, phases=IN_EACH),
    Fault('SIGSTOP of the recorder', Stall('recorder', 40), Must.STEADY, phases=IN_EACH),
    Fault('SIGKILL of the recorder, started again', Restart('recorder'), Must.STEADY, phases=IN_EACH),
    Fault('SIGSTOP of the plant', Stall('plant', 40), Must.BOUNDED, phases=IN_EACH),
    Fault(
        'a second controller', Second('controller'), Must.LATCHED, 200,
        said='2 publishers on strut_1/voltage, only one is allowed',
    ),
    Fault('a second plant', Second('plant'), Must.BOUNDED, said='of samples', back=LONG),
)  # fmt: skip

# each needs a graph of its own
ENDINGS = (
    Fault(
        'a stranger: voltages at 1 kHz for samples that are not there yet',
        _stranger('voltage', Mangling(add={'sequence': 1000})), Must.ENDS, said='another source of samples is running',
    ),
    Fault(
        'a stranger: voltages at 1 kHz with an absurd sequence',
        _stranger('voltage', Mangling(put={'sequence': FAR})), Must.ENDS, said='another source of samples is running',
    ),
)  # fmt: skip

# heading: faults
CHAPTERS = {
    'Messages on their way': MESSAGES,
    'Models on their way': MODELS,
    'Sensors': SENSORS,
    'Clocks': CLOCKS,
    'Strangers': STRANGERS,
    'Processes': PROCESSES,
    'Faults that end the graph': ENDINGS,
}
GOES_ON = tuple(fault for faults in CHAPTERS.values() for fault in faults if faults is not ENDINGS)
# of the short form
QUICK = (
    'all voltages lost',
    'accelerations with NaN, inf, 1e300, one in ten',
    'a voltage that is no number',
)
