# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Plays faults on a graph of one strut that is in one phase, and says what became of the voltage."""

import json
import signal
import time
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from bags import complaints, holds_messages
from faults import RATE, Fault, Mangle, Must, Restart, Second, Stall, Stranger
from processes import of_folder, shared_memory
from satvib_common.phases import Phase, PhasePlan
from satvib_common.struts.applied import Applied
from strut import CONTROLLER, HERE, IDENTIFIER, LOOP, PLANT, RECORDER, TIMEOUT, Strut

GUARD = 20.0  # V, the voltage limit of the controller and of the rig
CALM = 10 ** (1.0 / 20.0)  # 1 dB
WINDOW = 60  # samples, three periods of the disturbance
_PATIENCE = 5 * RATE  # samples for the payload to be calm again, before it is said that it is not
_ALONE = (
    40  # answers in a row, one for each sample, after which what a stranger has said is worked off
)

# each phase without end, the ones before it short; and the sample from which on faults may happen
_ORDER = (Phase.STANDBY, Phase.CALIBRATE, Phase.IDENTIFY, Phase.CONTROL)
_FIRST = (0, 60, 160, 560)
READY = {Phase.STANDBY: 100, Phase.CALIBRATE: 160, Phase.IDENTIFY: 560, Phase.CONTROL: 1060}


def plan_of(phase):
    """The phases up to this one, which has no end."""
    count = _ORDER.index(phase) + 1
    return PhasePlan(_ORDER[:count], _FIRST[:count])


class Outcome(NamedTuple):
    """What became of the voltage; times in samples, None: never.

    Attributes:
        zero: from the fault to 0 V at the coil.
        back: from its end until the payload is as calm as before, for a window.
        peak: V, largest voltage at the coil from the fault on.
        level: the payload while the fault was there, relative to before; 1 where no law acts.
        broken: what did not hold, in words.
        away: samples by which the machine was behind the clock meanwhile; every limit is longer by them.
    """

    zero: int | None
    back: int | None
    peak: float
    level: float
    broken: list[str]
    away: int = 0


class Scene:
    """A strut in one phase, a fault node between its plant and its controller, and a stranger."""

    def __init__(self, start, probe, phase=Phase.CONTROL):
        from std_msgs.msg import String

        self.phase = phase
        self.strut = Strut(start, probe, plan_of(phase), between=True)
        self.start, self.probe = start, probe
        self.orders = probe.publisher(String, '/faults')
        self.said = probe.collect(String, '/faults/said')
        self.bags, self.shared = [], set()
        self.begin('recorder')
        self.stranger = start.script(HERE / 'fault_node.py', 'stranger')
        probe.wait(lambda: self.orders.get_subscription_count() == 2)
        self.upper, self.state, self.voltage = {}, {}, {}
        self.read = 0
        self.until(READY[phase])
        now = range(self.strut.k - 5 * WINDOW, self.strut.k - WINDOW)
        self.calm = self.usual = 0.0
        if phase is Phase.CONTROL:
            self.calm = self.level(now[0], len(now))
        if phase in {Phase.IDENTIFY, Phase.CONTROL}:
            self.usual = float(np.std([self.voltage[k] for k in now]))

    # ---- what is seen

    def look(self):
        """Take the samples that have come."""
        new = self.strut.samples[self.read :]
        self.read += len(new)
        for s in new:
            self.upper[s.sequence] = s.upper
            self.state[s.sequence - 1] = Applied(s.applied_state)
            self.voltage[s.sequence - 1] = s.applied

    def until(self, k):
        self.probe.wait(lambda: self.strut.k >= k or self.plant_has_ended())
        self.look()
        if self.strut.k < k:
            raise AssertionError(self.last_words())

    def level(self, first, count=WINDOW):
        """RMS without the mean, m/s^2."""
        there = [self.upper[k] for k in range(first, first + count) if k in self.upper]
        return float(np.std(there)) if 2 * len(there) > count else float('nan')

    def is_calm(self, k, before):
        """Whether the law acts in a window from k on, what it asks is applied, and the payload is as calm as before."""
        # a test that is away for seconds has not heard all
        span = [i for i in range(k, k + WINDOW) if i in self.state]
        if 2 * len(span) < WINDOW:
            return False
        acts = np.std([self.voltage[i] for i in span]) >= 0.5 * self.usual
        applied = {self.state[i] for i in span} == {Applied.APPLIED}
        if self.phase is not Phase.CONTROL:
            return acts and applied
        return acts and applied and self.level(k) <= CALM * before

    def unrest(self, before):
        """Why the newest window is not calm."""
        k = self.strut.k - WINDOW
        span = [i for i in range(k, k + WINDOW) if i in self.state]
        states = {self.state[i].name for i in span}
        effort = np.std([self.voltage[i] for i in span])
        reasons = {s.reason for s in self.strut.states[-3:]}
        return (
            f'not calm after {_PATIENCE} samples: {self.level(k):.3g} m/s^2 before {before:.3g}, '
            f'{effort:.3g} V usually {self.usual:.3g}, {states}, {reasons}'
        )

    def settle(self, k):
        """Wait for a calm window."""
        self.until(k + WINDOW + 1)
        end = k + _PATIENCE
        while not self.is_calm(self.strut.k - WINDOW, self.calm) and self.strut.k < end:
            self.until(self.strut.k + 20)

    # ---- what is done

    def order(self, who, **order):
        """Ask a fault node, and wait until it is done; gives the samples at which it begins and ends."""
        from std_msgs.msg import String

        count = len(self.said)
        self.orders.publish(String(data=json.dumps({'who': who, **order})))
        found = []
        for i in (count, count + 1):
            # a stranger goes on without a plant, what stands between does not
            self.probe.wait(
                lambda i=i: len(self.said) > i or (who == 'between' and self.plant_has_ended())
            )
            if len(self.said) <= i:
                raise AssertionError(self.last_words())
            said = json.loads(self.said[i].data)
            found.append(self.strut.k if said['sequence'] is None else said['sequence'])
        return found

    def last_words(self):
        return f'the plant has ended: {self.strut.plant.said.splitlines()[-1:]}'

    def plant_has_ended(self):
        return self.strut.plant.popen.poll() is not None

    def act(self, fault, seed):
        """Do it; gives the samples at which it begins and ends."""
        act, strut = fault.act, self.strut
        match act:
            case Mangle():
                return self.order(
                    'between', topic=act.topic, count=act.count, seed=seed,
                    mangling=act.mangling.as_order(),
                )  # fmt: skip
            case Stranger():
                begin, end = self.order(
                    'stranger', topic=act.topic, kind=act.kind, count=act.count, seed=seed, rate=act.rate,
                    readers=act.readers, blank=act.blank, mangling=act.mangling.as_order(),
                )  # fmt: skip
                self.until_alone()
                return begin, max(end, strut.k - _ALONE)
            case Stall():
                process, begin = getattr(strut, act.node), strut.k
                process.send(signal.SIGSTOP)
                # the plant is the one that counts, so this one wait is by the clock of the test
                over = time.monotonic() + TIMEOUT + act.samples / RATE
                self.probe.wait(lambda: time.monotonic() > over)
                if fault.must is Must.ZERO:
                    self.probe.wait(lambda: strut.state() is Applied.SILENT)
                    begin = strut.voltages[-1].sequence
                process.send(signal.SIGCONT)
                return begin, strut.k
            case Restart():
                process, begin = getattr(strut, act.node), strut.k
                self.shared |= shared_memory(process.popen.pid)
                process.send(signal.SIGKILL)
                process.wait()
                if fault.must is Must.ZERO:
                    self.probe.wait(lambda: strut.state() is Applied.SILENT)
                    begin = strut.voltages[-1].sequence
                self.begin(act.node)
                if fault.must is Must.ZERO:
                    self.probe.wait(lambda: strut.state() is Applied.APPLIED)
                if act.node == 'recorder':
                    # a busy machine may need longer for its start than the graph has left
                    bag = self.bags[-1]
                    self.probe.wait(lambda: holds_messages(bag) or self.plant_has_ended())
                return begin, strut.k
            case Second(node='controller'):
                answers = len(strut.voltages)
                second = self.begin(act.node, beside=True)
                self.probe.wait(lambda: strut.state() is Applied.LATCHED)
                second.close()
                return self.first_rival(answers), strut.k
            case Second():
                begin, second = strut.k, self.begin(act.node, beside=True)
                self.probe.wait(lambda: second.popen.poll() is not None or self.is_latched())
                second.close()
                self.until_alone()
                self.reset()
                return begin, strut.k

    def first_rival(self, answers):
        """The first sample that was answered twice."""
        seen = set()
        for v in self.strut.voltages[answers - 1 :]:
            if v.sequence in seen:
                return v.sequence
            seen.add(v.sequence)
        raise AssertionError('nobody answered twice')

    def until_alone(self):
        """Wait until the plant gets one answer for each sample: what a stranger has said is then worked off."""
        voltages, last = self.strut.voltages, self.strut.k + _PATIENCE

        def is_alone():
            newest = [v.sequence for v in voltages[-_ALONE:]]
            follow = all(0 < b - a < 10 for a, b in pairwise(newest))
            return follow and abs(self.strut.k - newest[-1]) < 10

        self.probe.wait(lambda: is_alone() or self.strut.k > last or self.plant_has_ended())

    def begin(self, node, beside=False):
        """Start another process of a node."""
        strut, start = self.strut, self.start
        match node:
            case 'controller':
                made = start(*CONTROLLER, '/strut_1', **strut.law)
            case 'identifier':
                more = strut.aside('identified_model', strut='/strut_1')
                made = start(*IDENTIFIER, '/strut_1', more=more, **LOOP)
            case 'recorder':
                self.bags.append(start.folder / f'bag_{len(self.bags)}')
                made = start(*RECORDER, folder=str(self.bags[-1]))
            case _:
                more = strut.aside('strut_1/acceleration', 'strut_1/voltage')
                made = start(*PLANT, more=more, **strut.setting)
        if not beside:
            setattr(strut, node, made)
        return made

    def reset(self):
        from std_srvs.srv import Trigger

        for node in ('/plant_sim', '/strut_1/strut_controller'):
            self.probe.call(Trigger, f'{node}/reset', Trigger.Request())

    # ---- a fault

    def play(self, fault: Fault, seed: int) -> Outcome:
        """Play a fault, and wait until the payload is calm again."""
        self.settle(self.strut.k)
        before = max(self.level(self.strut.k - WINDOW), self.calm)
        heard = len(self.strut.states)
        begin, end = self.act(fault, seed)
        self.look()
        broken = []
        zero = None
        if fault.must in {Must.ZERO, Must.LATCHED}:
            zero, end = self.zero_of(fault, begin, end, broken)
        back = self.wait_for_calm(end, before)
        reasons = {s.reason for s in self.strut.states[heard:] if s.fault}
        if back is None and reasons:
            broken.append(f'the controller latched 0 V: {", ".join(reasons)}')
        span = [k for k in range(begin, self.strut.k) if k in self.state]
        self.reset()
        peak = max(abs(self.voltage[k]) for k in span)
        in_control = self.phase is Phase.CONTROL
        level = self.level(begin, max(end - begin, WINDOW)) / before if in_control else 1.0
        if fault.must is Must.STEADY:
            away = [k for k in span if self.state[k] is not Applied.APPLIED]
            if away:
                what = self.state[away[0]].name
                broken.append(f'{len(away)} voltages were not applied, first {what}')
            if level > 10 ** (fault.louder / 20.0):
                broken.append(f'the payload was {20 * np.log10(level):.1f} dB louder')
        away = self.strut.away(begin - 1, self.strut.k)
        if back is None or back - end > fault.back + away:
            how = f'calm after {back - end} samples' if back is not None else self.unrest(before)
            broken.append(f'{how}; {fault.back} and {away} are allowed')
        if not peak <= GUARD:
            broken.append(f'{peak:g} V at the coil')
        if fault.said and not any(fault.said in p.said for p in self.start.started):
            broken.append(f'nobody said "{fault.said}"')
        ended = [p.name for p in self.processes() if p.popen.poll() is not None]
        if ended:
            broken.append(f'{", ".join(ended)} ended')
        return Outcome(zero, None if back is None else back - end, peak, level, broken, away)

    def zero_of(self, fault, begin, end, broken):
        """Samples from the fault to 0 V, and the end of the fault; a latch is released by `~/reset`."""
        limit = fault.within + (round(TIMEOUT * RATE) if fault.silence else 0)
        latched = fault.must is Must.LATCHED
        if latched:
            # no longer than is allowed, and no shorter
            last = max(begin + limit, end) + WINDOW
            self.probe.wait(lambda: self.is_latched() or self.strut.k > last)
            self.until(self.strut.k + WINDOW)
            end = self.strut.k
            # a controller that has just begun answers 0 V, too: the latch is what stays
            first = end
            while first > begin and self.voltage.get(first - 1, 0.0) == 0.0:
                first -= 1
            found = [k for k in range(first, end) if k in self.voltage]
            if not self.is_latched():
                broken.append('0 V was not kept until reset')
            self.reset()
        else:
            silent = Applied.SILENT
            found = [k for k in range(begin, self.strut.k) if self.state.get(k) is silent]
        zero = found[0] if found else None
        away = self.strut.away(begin - 1, begin + limit if zero is None else zero)
        if zero is None or zero - begin > limit + away:
            after = 'never' if zero is None else f'after {zero - begin} samples'
            broken.append(f'0 V {after}; {limit} are allowed, and {away} that the machine was away')
        if any(self.voltage[k] != 0.0 for k in found):
            broken.append('a voltage while it is said to be 0 V')
        return (None if zero is None else zero - begin), end

    def is_latched(self):
        """Whether plant or controller say that 0 V is kept until `~/reset`."""
        return self.strut.state() is Applied.LATCHED or self.strut.states[-1].fault

    def processes(self):
        """Those of the graph, as they are now."""
        strut = self.strut
        return strut.plant, strut.identifier, strut.controller, strut.recorder

    def wait_for_calm(self, end, before):
        """The first sample from which on the payload is as calm as before, for a window."""
        k = end
        while k < end + _PATIENCE:
            self.until(k + WINDOW + 2)
            if self.is_calm(k, before):
                return k
            k += 5
        return None

    # ---- the end

    def end(self, fault: Fault | None = None, seed: int = 0) -> Outcome:
        """End the graph, by a fault or by SIGINT; says what is wrong then with exit codes, bags, processes, memory."""
        processes = self.processes()
        begin = self.strut.k
        if fault is None:
            self.strut.plant.send(signal.SIGINT)
        else:
            self.act(fault, seed)
        broken = []
        code = self.strut.plant.wait()
        if code != (fault is not None):
            broken.append(f'plant_sim: exit code {code}')
        if fault is not None and fault.said not in self.strut.plant.said:
            broken.append(f'the plant did not say "{fault.said}"')
        self.look()
        for process in processes[1:]:
            process.send(signal.SIGINT)
        broken += [
            f'{p.name}: exit code {p.popen.returncode}' for p in processes[1:] if p.wait() != 0
        ]
        broken += [text for bag in self.bags for text in complaints(bag)]
        alive = (p.popen.pid for p in self.start.started if p.popen.poll() is None)
        shared = self.shared.union(*map(shared_memory, alive))
        self.start.close()
        broken += [f'process {pid} is left' for pid in of_folder(self.start.folder)]
        if shared:
            broken.append(f'{len(shared)} files in shared memory were used')
        peak = max((abs(v) for k, v in self.voltage.items() if k >= begin), default=0.0)
        return Outcome(None, None, peak, 1.0, broken)
