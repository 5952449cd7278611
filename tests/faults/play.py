# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Plays faults on a graph of one strut that is in CONTROL, and says what became of the voltage."""

import json
import signal
import time
from typing import NamedTuple

import numpy as np
from faults import RATE, Fault, Mangle, Must, Restart, Second, Stall, Stranger
from processes import left_in_shared_memory, shared_memory
from satvib_common.struts.applied import Applied
from strut import CONTROLLER, HERE, IDENTIFIER, LAW, LOOP, SOON, TIMEOUT, Strut

GUARD = 20.0  # V, the voltage limit of the controller and of the rig
CALM = 10 ** (1.0 / 20.0)  # 1 dB
STEADY = 10 ** (2.0 / 20.0)  # 2 dB, of a window that may be short
WINDOW = 60  # samples, three periods of the disturbance
_PATIENCE = 5 * RATE  # samples for the payload to be calm again, before it is said that it is not


class Outcome(NamedTuple):
    """What became of the voltage; times in samples, None: never.

    Attributes:
        zero: from the fault to 0 V at the coil.
        back: from its end until the payload is as calm as before, for a window.
        peak: V, largest voltage at the coil from the fault on.
        level: the payload while the fault was there, relative to before.
        broken: what did not hold, in words.
    """

    zero: int | None
    back: int | None
    peak: float
    level: float
    broken: list[str]


class Scene:
    """A strut in CONTROL, a fault node between its plant and its controller, and a stranger."""

    def __init__(self, start, probe):
        from std_msgs.msg import String

        self.strut = Strut(start, probe, SOON, between=True)
        self.start, self.probe = start, probe
        self.orders = probe.publisher(String, '/faults')
        self.said = probe.collect(String, '/faults/said')
        self.bag = start.folder / 'bag'
        self.recorder = start('satvib_bringup', 'recorder', folder=str(self.bag))
        self.stranger = start.script(HERE / 'fault_node.py', 'stranger')
        probe.wait(lambda: self.orders.get_subscription_count() == 2)
        self.upper, self.state, self.voltage = {}, {}, {}
        self.read = 0
        self.until(1200)
        now = range(self.strut.k - 5 * WINDOW, self.strut.k - WINDOW)
        self.calm = self.level(now[0], len(now))
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
        self.strut.until(k)
        self.look()

    def level(self, first, count=WINDOW):
        """RMS without the mean, m/s^2."""
        return float(np.std([self.upper[k] for k in range(first, first + count)]))

    def sample_at(self, nanoseconds):
        """The sample of an instant of the clock of this machine."""
        from satvib_common.ros.convert import nanoseconds as of

        last = self.strut.samples[-1]
        return last.sequence + (nanoseconds - of(last.header.stamp)) * RATE // 10**9

    def is_calm(self, k, before):
        """Whether the law acts in a window from k on, what it asks is applied, and the payload is as calm as before."""
        span = range(k, k + WINDOW)
        acts = np.std([self.voltage[i] for i in span]) > 0.5 * self.usual
        applied = {self.state[i] for i in span} == {Applied.APPLIED}
        return acts and applied and self.level(k) <= CALM * before

    def settle(self, k):
        """Wait for a calm window."""
        self.until(k + WINDOW + 1)
        end = k + _PATIENCE
        while not self.is_calm(self.strut.k - WINDOW, self.calm) and self.strut.k < end:
            self.until(self.strut.k + 20)

    # ---- what is done

    def order(self, who, **order):
        """Ask a fault node, and wait until it is done; gives when it began and ended."""
        from std_msgs.msg import String

        count = len(self.said)
        self.orders.publish(String(data=json.dumps({'who': who, **order})))
        self.probe.wait(lambda: len(self.said) >= count + 2)
        return [json.loads(m.data) for m in self.said[count : count + 2]]

    def act(self, fault, seed):
        """Do it; gives the samples at which it begins and ends."""
        act, strut = fault.act, self.strut
        match act:
            case Mangle():
                begun, done = self.order(
                    'between', topic=act.topic, count=act.count, seed=seed,
                    mangling=act.mangling.as_order(),
                )  # fmt: skip
                assert done['touched'] > 0
                return self.sample_at(begun['time']), self.sample_at(done['time'])
            case Stranger():
                begun, done = self.order(
                    'stranger', topic=act.topic, kind=act.kind, count=act.count, seed=seed, rate=act.rate,
                    readers=act.readers, mangling=act.mangling.as_order(),
                )  # fmt: skip
                return self.sample_at(begun['time']), self.sample_at(done['time'])
            case Stall():
                process = getattr(strut, act.node)
                process.send(signal.SIGSTOP)
                begin = self.sample_at(time.time_ns())
                strut.until(begin + round(TIMEOUT * RATE) + act.samples)
                process.send(signal.SIGCONT)
                return begin, self.sample_at(time.time_ns())
            case Restart():
                process = getattr(strut, act.node)
                process.send(signal.SIGKILL)
                begin = self.sample_at(time.time_ns())
                process.wait()
                if fault.must is Must.ZERO:
                    self.probe.wait(lambda: strut.state() is Applied.SILENT)
                self.begin(act.node)
                if fault.must is Must.ZERO:
                    self.probe.wait(lambda: strut.state() is Applied.APPLIED)
                return begin, strut.k
            case Second():
                answers = len(strut.voltages)
                second = self.begin(act.node, beside=True)
                self.probe.wait(lambda: strut.state() is Applied.LATCHED)
                second.close()
                return self.first_rival(answers), strut.k

    def first_rival(self, answers):
        """The first sample that was answered twice."""
        seen = set()
        for v in self.strut.voltages[answers - 1 :]:
            if v.sequence in seen:
                return v.sequence
            seen.add(v.sequence)
        raise AssertionError('nobody answered twice')

    def begin(self, node, beside=False):
        """Start another process of a node."""
        strut = self.strut
        if node == 'controller':
            made = self.start(*CONTROLLER, '/strut_1', **LAW)
        else:
            more = strut.aside('identified_model', strut='/strut_1')
            made = self.start(*IDENTIFIER, '/strut_1', more=more, **LOOP)
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
        span = range(begin, self.strut.k)
        self.reset()
        peak = max(abs(self.voltage[k]) for k in span)
        level = self.level(begin, max(end - begin, WINDOW)) / before
        if fault.must is Must.STEADY:
            away = [k for k in span if self.state[k] is not Applied.APPLIED]
            if away:
                what = self.state[away[0]].name
                broken.append(f'{len(away)} voltages were not applied, first {what}')
            if level > STEADY:
                broken.append(f'the payload was {20 * np.log10(level):.1f} dB louder')
        if back is None or back - end > fault.back:
            broken.append(f'calm after {back and back - end} samples, {fault.back} are allowed')
        if not peak <= GUARD:
            broken.append(f'{peak:g} V at the coil')
        if fault.said and not any(fault.said in p.said for p in self.start.started):
            broken.append(f'nobody said "{fault.said}"')
        ended = [p.name for p in self.processes() if p.popen.poll() is not None]
        if ended:
            broken.append(f'{", ".join(ended)} ended')
        return Outcome(zero, None if back is None else back - end, peak, level, broken)

    def zero_of(self, fault, begin, end, broken):
        """Samples from the fault to 0 V, and the end of the fault; a latch is released by `~/reset`."""
        limit = fault.within + (round(TIMEOUT * RATE) if fault.silence else 0)
        latched = fault.must is Must.LATCHED
        if latched:
            # no longer than is allowed, and no shorter
            last = max(begin + limit, end) + WINDOW
            self.probe.wait(lambda: self.is_latched() or self.strut.k > last)
            self.until(self.strut.k + WINDOW)
            found = [k for k in range(begin, self.strut.k) if self.voltage[k] == 0.0]
            end = self.strut.k
            # a controller that has just begun answers 0 V, too: the latch is what stays
            while found and found != list(range(found[0], end)):
                found = found[1:]
            if not self.is_latched():
                broken.append('0 V was not kept until reset')
            self.reset()
        else:
            found = [k for k in range(begin, self.strut.k) if self.state[k] is Applied.SILENT]
        if not found or found[0] - begin > limit:
            broken.append(f'0 V after {found and found[0] - begin} samples, {limit} are allowed')
        if any(self.voltage[k] != 0.0 for k in found):
            broken.append('a voltage while it is said to be 0 V')
        return (found[0] - begin if found else None), end

    def is_latched(self):
        """Whether plant or controller say that 0 V is kept until `~/reset`."""
        return self.strut.state() is Applied.LATCHED or self.strut.states[-1].fault

    def processes(self):
        """Those of the graph, as they are now."""
        strut = self.strut
        return strut.plant, strut.identifier, strut.controller, self.recorder

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
        """End the graph, by a fault or by SIGINT; says what is wrong then: exit codes, the bag, shared memory."""
        from rosbags.highlevel import AnyReader

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
        with AnyReader([self.bag]) as reader:
            counts = {c.topic: c.msgcount for c in reader.connections}
            for connection, _, raw in reader.messages():
                reader.deserialize(raw, connection.msgtype)
        topics = (f'/strut_1/{topic}' for topic in ('acceleration', 'voltage', 'controller_state'))
        broken += [f'the bag has {counts.get(t)} of {t}' for t in topics if counts.get(t, 0) < 1000]
        segments = set().union(
            *(shared_memory(p.popen.pid) for p in self.start.started if p.popen.poll() is None)
        )
        self.start.close()
        if left := left_in_shared_memory(segments):
            broken.append(f'{len(left)} segments are left in shared memory')
        peak = max((abs(v) for k, v in self.voltage.items() if k >= begin), default=0.0)
        return Outcome(None, None, peak, 1.0, broken)
