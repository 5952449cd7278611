# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltages at the coils: what arrived, when, and what happens when nothing arrives.

Real time: a voltage is in force from its arrival until the next one (zero-order hold). It counts when it is *fresh*: it
answers a sample that is at most `timeout` old. A strut that has been heard once and then gets no fresh voltage for
longer than that is at 0 V at once, because at 0 V a coil only damps. A plant that is behind its clock counts a silence
by its samples and by the clock: samples that it makes up for in one go are no silence, and its delay does not hide one.

| `after_silence` | when fresh voltages come again |
|---|---|
| resume | they are applied, with a share that rises from 0 to 1 over `return_time` |
| latch | 0 V until `reset` |

A voltage that is not a number, two controllers that answer the same samples, and `stop` latch 0 V in any case. After
`reset` the voltage rises in the same way. In lockstep nothing is late, and only `stop` keeps a voltage from its coil.

Times are s on any steady clock, given by the caller.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
from satvib_common.arrays import Array, Integers
from satvib_common.sequence import Rivals
from satvib_common.struts.applied import Applied

_NEVER = -math.inf
STOPPED = 'stopped by request'
RIVALS = 'two controllers answer its samples'


class Commands:
    """The command of each strut.

    Args:
        names: of the struts.
        timeout: s, longest silence, and oldest sample that a voltage may answer.
        period: s, sample period.
        resume: go on after a silence; else latch.
        return_time: s, over which the voltage rises after a silence.
        rivals: says who else answers the samples of a strut, for people.
        limit: V, what the amplifiers can give in real time, either way.

    Attributes:
        late, stale: voltages that answered a sample before the present one; those among them that did not count.
        fault: (struts) bool, 0 V is latched.
        why: (struts) texts, why the voltage is not applied; empty where it is.
        voltage: (struts) V, in force at the end of the last period.
        state: (struts) an `Applied` for it.
        events: lines for the log; the reader removes them.
    """

    def __init__(
        self,
        names: Sequence[str],
        timeout: float,
        period: float,
        resume: bool = True,
        return_time: float = 0.3,
        rivals: Callable[[int], str] = lambda _: RIVALS,
        limit: float = math.inf,
    ) -> None:
        struts = len(names)
        self.names, self.period, self._who = tuple(names), period, rivals
        self.apply(timeout, resume, return_time)
        self.late = self.stale = 0
        self.fault = np.zeros(struts, dtype=bool)
        self.why = [''] * struts
        self.events: list[str] = []
        self.voltage = np.zeros(struts)
        self.state: Integers = np.full(struts, int(Applied.APPLIED))
        self._limit = limit
        self._limited = np.zeros(struts, dtype=bool)
        self._wanted = np.zeros(struts)
        self._share = np.ones(struts)
        self._last_time = np.full(struts, _NEVER)  # of the clock
        self._last_due = np.full(struts, _NEVER)  # of the samples
        self._answered = [-1] * struts
        self._arrival = np.zeros(struts)
        self._rivals = [Rivals() for _ in names]
        self._usual = False  # every voltage of the last period was applied as it was asked for

    def apply(self, timeout: float, resume: bool, return_time: float) -> None:
        """Take new settings."""
        self.timeout, self.resume, self.return_time = timeout, resume, return_time

    def take(
        self, strut: int, sequence: int, voltage: float, now: float, since: float, k: int,
        within: float | None = None,
    ) -> None:  # fmt: skip
        """Take a voltage for one strut.

        Args:
            strut: from 0.
            sequence: of the sample that it answers.
            voltage: V.
            now: s.
            since: s since sample k.
            k: the present sample.
            within: s, when that is by the instants at which samples are due; None: as `now`.
        """
        if sequence > k:
            return  # the answer to a sample that is not there yet
        last = self._answered[strut]
        self.late += sequence < k
        # a controller that comes to rest says 0 V for a sample that it has answered
        if self.is_answered(strut, sequence <= last and voltage != 0.0):
            return
        self._answered[strut] = max(sequence, last)
        if not math.isfinite(voltage):
            self.latch(strut, f'the voltage of sample {sequence} is {voltage}')
        elif (k - sequence) * self.period > self.timeout:
            self.stale += 1
        elif not self.fault[strut]:
            self._last_time[strut] = now
            self._last_due[strut] = now if within is None else within
            self._wanted[strut] = min(max(voltage, -self._limit), self._limit)
            self._limited[strut] = abs(voltage) > self._limit
            self._arrival[strut] = since

    def is_answered(self, strut: int, again: bool) -> bool:
        """Take whether a voltage answers a sample that has its answer; many of them latch 0 V. Gives `again`."""
        if self._rivals[strut].saw(again):
            self.latch(strut, self._who(strut))
        return again

    def latch(self, strut: int, why: str) -> None:
        """Latch 0 V."""
        if not self.fault[strut]:
            self.fault[strut] = True
            self._tell(strut, why)

    def stop(self) -> None:
        """Latch 0 V at every strut."""
        for strut in range(len(self.names)):
            self.latch(strut, STOPPED)

    def reset(self) -> None:
        """Release the faults; the next voltages count again there, and rise from 0 V. Other struts feel nothing."""
        self._share[self.fault] = 0.0
        self._last_time[self.fault] = self._last_due[self.fault] = _NEVER
        self._wanted[self.fault] = 0.0
        for strut in np.flatnonzero(self.fault):
            self._rivals[strut].reset()
            self._tell(int(strut), '')
        self.fault[:] = False

    def new_run(self) -> None:
        """The samples count from 0 again."""
        self._answered = [-1] * len(self.names)

    def period_over(self, due: float, now: float | None = None) -> tuple[Array, Array]:
        """Give what a period has seen: voltages (struts) and their arrivals (struts, s).

        Args:
            due: s, when it should end.
            now: s; None: it is punctual.
        """
        arrival, self._arrival = self._arrival, np.zeros_like(self._arrival)
        quiet = due - self._last_due > self.timeout
        if now is not None and quiet.any():
            quiet = quiet & (now - self._last_time > self.timeout)
        if self._usual and not (quiet | self._limited | self.fault).any():
            self.voltage = self._wanted.copy()
            return self.voltage, arrival
        never = self._last_time == _NEVER
        silent = quiet & ~never & ~self.fault
        for strut in np.flatnonzero(silent & (self.state != Applied.SILENT)):
            what = f'no fresh voltage for {self.timeout * 1e3:g} ms'
            if self.resume:
                self._tell(int(strut), what)
            else:
                self.latch(int(strut), what)
        for strut in np.flatnonzero((self.state == Applied.SILENT) & ~quiet & ~self.fault):
            self._tell(int(strut), '')
        off = silent | self.fault
        self._share = np.where(off, 0.0, self._share)
        self._apply(self._wanted, off | never)
        limited = self._limited & (self.state == Applied.APPLIED)
        self.state = np.where(limited, Applied.LIMITED, self.state)
        self.state = np.where(never, Applied.WAITING, self.state)
        self.state = np.where(silent, Applied.SILENT, self.state)
        self.state = np.where(self.fault, Applied.LATCHED, self.state)
        self._usual = bool((self.state == Applied.APPLIED).all())
        return self.voltage, arrival

    def pass_on(self, asked: Array) -> Array:
        """In lockstep: give what the coils get of the voltages (struts, V) that answer the present sample."""
        if self._usual and not self.fault.any():
            self.voltage = asked.copy()
            return self.voltage
        self._apply(asked, self.fault)
        self.state = np.where(self.fault, Applied.LATCHED, self.state)
        self._usual = bool((self.state == Applied.APPLIED).all())
        return self.voltage

    def counts(self) -> dict[str, object]:
        """Give the counts for the diagnostics."""
        return {'late voltages': self.late, 'voltages too late': self.stale}

    def complaint(self) -> str:
        """Which struts have not what was asked for, why, and how that ends; empty when all have it."""
        said = []
        for name, fault, why in zip(self.names, self.fault, self.why, strict=True):
            if fault:
                said.append(f'{name}: 0 V latched: {why}; call ~/reset to release it')
            elif why:
                said.append(f'{name}: 0 V: {why}; it goes on when they are fresh again')
        return '; '.join(said)

    def _apply(self, asked: Array, off: Array) -> None:
        """Let the voltages rise; `off` (struts) is where they do not."""
        rise = self.period / max(self.return_time, self.period)
        self._share = np.where(off, self._share, np.minimum(self._share + rise, 1.0))
        self.voltage = np.where(off, 0.0, asked * self._share)
        self.state = np.where(self._share < 1.0, Applied.RETURNING, Applied.APPLIED)

    def _tell(self, strut: int, why: str) -> None:
        """Keep why a strut has 0 V (empty: it has its voltage again), and write a line."""
        before, self.why[strut] = self.why[strut], why
        name = self.names[strut]
        if not why:
            self.events.append(f'{name}: voltages are applied again, rising from 0 V ({before})')
        elif self.fault[strut]:
            self.events.append(f'{name}: 0 V, latched: {why}; call ~/reset to release it')
        else:
            self.events.append(f'{name}: 0 V: {why}; it goes on when they are fresh again')
