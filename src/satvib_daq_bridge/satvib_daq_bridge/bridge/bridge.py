# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The bridge without ROS: samples up, voltages down, and every reason to stop.

The outputs belong to the guardian. The bridge turns volts into accelerations without bias, watches the sensors, the
device's silence and the deadlines, counts samples from the beginning of the run, and holds the state machine; every
change of state goes to the guardian at once. Times are s of the monotonic clock, given by the caller.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.errors import SatvibError
from satvib_common.struts.applied import Applied

from satvib_daq_bridge.bridge.bias import SensorBias
from satvib_daq_bridge.bridge.sensors import Sensors
from satvib_daq_bridge.bridge.timing import Timing
from satvib_daq_bridge.channels import Channels
from satvib_daq_bridge.guardian import link
from satvib_daq_bridge.parameters import BridgeParameters
from satvib_daq_bridge.states import State, StateMachine, Transition

_APPLIED = {
    State.ACTIVE: Applied.APPLIED,
    State.ARMED: Applied.WAITING,
    State.IDLE: Applied.WAITING,
}  # fmt: skip
# times the longest silence, in every state but ACTIVE
_IDLE_PATIENCE = 10.0


@dataclass(frozen=True)
class Published:
    """What the graph gets of a sample.

    Attributes:
        sequence: from the beginning of the run.
        time: s of the monotonic clock, when it was taken.
        upper, lower: (struts) m/s^2 without bias; NaN where there is no sensor.
        upper_clipped, lower_clipped: (struts) the sensor stands at an end of its range.
        applied: (struts) V at the coils when the sample was taken.
        applied_state: (struts) what became of the voltages that were asked for, an `Applied`.
    """

    sequence: int
    time: float
    upper: Array
    lower: Array
    upper_clipped: Mask
    lower_clipped: Mask
    applied: Array
    applied_state: Integers


class Bridge:
    """One bridge.

    Args:
        channels, parameters: checked.
        send: takes messages for the guardian (`link`).
        changed: called with each change of state.
        latched: the fault that a bridge before this one has latched.

    Attributes:
        running: samples are published and counted.
        published: the last sample that was.
        over: why the run has ended: the plan is done, or the recording that is played; empty before.
    """

    def __init__(
        self,
        channels: Channels,
        parameters: BridgeParameters,
        send: Callable[[bytes], object],
        changed: Callable[[Transition], None] = lambda _: None,
        latched: Transition | None = None,
    ) -> None:
        self.channels, self.parameters = channels, parameters
        self._send, self._on_change = send, changed
        self.struts = [strut.name for strut in channels.struts]
        self.sensors = Sensors(channels.inputs, parameters.sample_rate, parameters.railed_samples)
        self.bias = SensorBias(channels.inputs, parameters.sample_rate, parameters.calibration_time)
        self.timing = Timing(parameters.period)
        self.states = StateMachine(self._changed, latched)
        self.virtual = False
        self.running = False
        self.over = ''
        self.figures: dict[str, float] = {}
        self.lost = 0
        self.refused = 0
        self._silent_since = math.inf
        self._sequence = -1
        self._base = 0
        self.published = -1
        self._end = -1  # of the plan; -1: there is none yet, 0: without end
        self._held = False
        self._answered = np.full(len(self.struts), -1)
        self._missed = 0
        self._lower = self._lower_positions()

    def configured(self, virtual: bool, now: float) -> None:
        """The guardian is ready: begin to read, at 0 V."""
        self.virtual = virtual
        self._sequence = -1
        self._silent_since = now
        self.sensors.reset()
        self.states.configure('the device is there; its sensors are read, its outputs are at 0 V')

    def released(self, reason: str) -> None:
        """The guardian is gone."""
        self._silent_since = math.inf
        self.states.unconfigure(reason)

    def restarted(self, now: float) -> None:
        """A new guardian is ready after a fault; its samples count from 0 again."""
        self._base -= self._sequence + 1
        self._sequence = -1
        self._silent_since = now
        self.sensors.reset()
        self._changed_mode()

    def schedule(self, end: int) -> None:
        """Take the end of the plan (samples; 0: without end)."""
        self._end = end
        self._try_to_begin()

    def arm(self, objection: str = '') -> None:
        """IDLE -> ARMED.

        Args:
            objection: what the caller knows against it.

        Raises:
            SatvibError: not possible now; the message says why.
        """
        if self.states.state is State.IDLE:
            if not self.bias.learnt:
                raise SatvibError('arm: refused: the bias of the sensors is not learnt yet')
            if objection:
                raise SatvibError(f'arm: refused: {objection}')
        self.states.arm('armed by request')
        self._try_to_begin()

    def calibrate(self) -> None:
        """Measure the bias again, in IDLE before a run.

        Raises:
            SatvibError: not possible now.
        """
        if self.states.state is not State.IDLE or self.running:
            what = 'a run is on' if self.running else self.states.state.name
            raise SatvibError(f'calibrate: refused ({what}); possible in IDLE, before a run')
        self.bias.restart()
        if self._held:
            self._next()

    def reset(self) -> None:
        """FAULT, ESTOP -> IDLE.

        Raises:
            SatvibError: there is nothing to reset.
        """
        # a reset that is refused releases nothing: the guardian may have a fault of which no word has come yet
        self.states.reset()
        self._missed = 0
        self.sensors.reset()
        self._send(link.pack(link.ToGuardian.RESET))

    def command(self, strut_index: int, sequence: int, voltage: float) -> None:
        """Take a controller's voltage (V at the coil) for a published sample."""
        taken = sequence + self._base
        if (
            not self.running
            or taken < 0
            or not self._answered[strut_index] < sequence <= self.published
        ):
            self.refused += 1
            return
        if not math.isfinite(voltage):
            self.states.fault(
                f'{self.struts[strut_index]}: the voltage of sample {sequence} is {voltage}'
            )
            return
        self._answered[strut_index] = sequence
        message = link.pack_command(strut_index, taken, voltage)
        if self.virtual:
            # the guardian acts on the last voltage of a sample: the state comes first
            self._try_to_activate()
            self._send(message)
        else:
            self._send(message)
            self._try_to_activate()

    def take(self, message: bytes, now: float) -> Published | None:
        """Take a message of the guardian; gives a sample to publish, or None."""
        kind = message[0]
        if kind == link.ToBridge.SAMPLE:
            return self._sample(link.read_sample(message), now)
        if kind == link.ToBridge.FAULT:
            self.states.fault(link.read_text(message))
        elif kind == link.ToBridge.FIGURES:
            self.figures = link.read_text(message)
        elif kind == link.ToBridge.ENDED:
            self.states.stop('the record is over')
            self.over = link.read_text(message)
        return None

    def tick(self, now: float) -> None:
        """Watch the silence of the device; at 0 V there is more patience."""
        silence = now - self._silent_since
        allowed = self.parameters.silence
        if self.states.state is not State.ACTIVE:
            allowed *= _IDLE_PATIENCE
        if silence > allowed and not self.virtual:
            self.states.fault(
                f'no sample for {silence * 1e3:.0f} ms: the device or its line stalls'
            )

    def awaited(self) -> str:
        """Give what the run needs to begin, in words; empty: nothing."""
        if self.running or self.over or self.states.state not in {State.IDLE, State.ARMED}:
            return ''
        if not self.bias.learnt:
            return 'the bias of the sensors, at rest'
        if self.parameters.wait_for_schedule and self._end < 0:
            return 'the schedule'
        return '~/arm' if self.states.state is State.IDLE else ''

    def diagnose(self) -> dict[str, object]:
        """Give state, counts, times, bias, and the guardian's figures."""
        counts = {
            'state': self.states.state.name,
            'reason': self.states.reason,
            'sequence': self.published,
            'samples lost': self.lost,
            'answers refused': self.refused,
        }
        biases = self.bias.to_mapping() if self.bias.learnt else {}
        learnt = {f'{name} bias': value['bias'] for name, value in biases.items()}
        return counts | self.timing.figures() | self.figures | learnt

    def guardian_ended(self, how: str) -> None:
        """Take note that the process that owns the outputs is gone."""
        self._silent_since = math.inf
        self.states.fault(f'the guardian {how}')

    def _sample(self, taken: link.Taken, now: float) -> Published | None:
        self._silent_since = now
        self.lost += taken.sequence - self._sequence - 1 if self._sequence >= 0 else 0
        self._sequence = taken.sequence
        self.timing.add(taken.late, taken.latency)
        self._watch(taken)
        acceleration = self.sensors.acceleration(taken.volts)
        if not self.running:
            self._rest(acceleration)
            return None
        sequence = taken.sequence - self._base
        if self._end > 0 and sequence >= self._end:
            self.running = False
            self.over = f'{self._end} samples of {len(self.struts)} struts; {self.lost} lost'
            self.states.stop('the schedule is over')
            return None
        self.published = sequence
        corrected = self.bias.correct(acceleration)
        clipped = self.sensors.clipped(taken.volts, self.bias.value)
        count = len(self.struts)
        return Published(
            sequence,
            taken.time,
            upper=corrected[:count],
            lower=np.append(corrected, math.nan)[self._lower],
            upper_clipped=clipped[:count],
            lower_clipped=np.append(clipped, False)[self._lower],
            applied=taken.coil,
            applied_state=self._applied_state(sequence, taken),
        )

    def _applied_state(self, sequence: int, taken: link.Taken) -> Integers:
        """What became of the voltages (struts) until this sample."""
        count = len(self.struts)
        state = _APPLIED.get(self.states.state, Applied.LATCHED)
        if sequence == 0 and state is Applied.WAITING:
            state = Applied.APPLIED  # nothing has been asked for
        states = np.full(count, int(state))
        if state is Applied.APPLIED and taken.saturated:
            limited = (taken.saturated >> np.arange(count)) & 1 == 1
            states = np.where(limited, int(Applied.LIMITED), states)
        return states

    def _watch(self, taken: link.Taken) -> None:
        wrong = self.sensors.watch(taken.volts)
        if wrong:
            self.states.fault(wrong)
        if self.states.state is not State.ACTIVE or self.virtual:
            self._missed = 0
            return
        in_time = taken.latency < self.parameters.period
        self._missed = 0 if in_time else self._missed + 1
        self.timing.missed += not in_time
        if 0 < self.parameters.missed_limit <= self._missed:
            self.states.fault(f'{self._missed} deadlines missed in a row')

    def _rest(self, acceleration: Array) -> None:
        """Before a run: measure the bias, then wait for the beginning."""
        if self.states.state is State.IDLE and not self.bias.learnt:
            try:
                self.bias.add(acceleration)
            except SatvibError as error:
                self.states.fault(f'calibration: {error}')
        self._held = self.virtual
        if not self._try_to_begin() and not self.bias.learnt and self._held:
            self._next()

    def _try_to_begin(self) -> bool:
        """Begin the run when everything is there; the next sample is its first."""
        ready = self._end >= 0 and self.states.state is State.ARMED
        if self.parameters.wait_for_schedule is False:
            ready = self.states.state in {State.IDLE, State.ARMED}
        if self.running or self.over or not (ready and self.bias.learnt and self._sequence >= 0):
            return False
        self.running = True
        self.timing = Timing(self.parameters.period)
        self._base = self._sequence + 1
        self._answered[:] = -1
        self._send(link.pack(link.ToGuardian.BEGIN))
        if self._held:
            self._next()
        return True

    def _try_to_activate(self) -> None:
        fresh = self.published - math.floor(self.parameters.max_age * self.parameters.sample_rate)
        oldest = int(self._answered.min())
        if self.states.state is State.ARMED and oldest >= 0 and oldest >= fresh:
            self.states.activate()

    def _next(self) -> None:
        self._held = False
        self._send(link.pack(link.ToGuardian.NEXT))

    def _changed(self, transition: Transition) -> None:
        self._changed_mode()
        self._on_change(transition)

    def _changed_mode(self) -> None:
        self._send(link.pack_mode(self.states.state))

    def _lower_positions(self) -> Integers:
        """Where each strut's lower sensor stands among the inputs; one beyond the end: nowhere."""
        names = [name for name, _ in self.channels.inputs]
        wanted = [f'{name}.lower' for name in self.struts]
        return np.array([names.index(w) if w in names else len(names) for w in wanted])
