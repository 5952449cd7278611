# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The states of a bridge and the only ways from one to another.

    UNCONFIGURED --configure--> IDLE --arm--> ARMED --activate--> ACTIVE
                                  ^             |                    |
                                  +----stop-----+--------stop--------+
    IDLE, ARMED, ACTIVE --fault--> FAULT;   any but UNCONFIGURED --estop--> ESTOP
    FAULT, ESTOP --reset--> IDLE

FAULT and ESTOP latch, through `unconfigure` and `configure` too: only `reset` ends them, and it only leads to IDLE.
Arming is a separate act. Voltages other than 0 leave in ACTIVE alone.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from satvib_common.errors import SatvibError


class State(Enum):
    """The state of a bridge."""

    UNCONFIGURED = 0
    IDLE = 1
    ARMED = 2
    ACTIVE = 3
    FAULT = 4
    ESTOP = 5


_LATCHED = {State.FAULT, State.ESTOP}


@dataclass(frozen=True)
class Transition:
    """One change of state and its reason."""

    before: State
    after: State
    reason: str

    def __str__(self) -> str:
        return f'{self.before.name} -> {self.after.name}: {self.reason}'


class StateMachine:
    """Holds the state; `changed` is called after every change.

    Args:
        changed: called with each transition.
        latched: the fault that a machine before this one has latched.
    """

    def __init__(
        self,
        changed: Callable[[Transition], None] = lambda _: None,
        latched: Transition | None = None,
    ) -> None:
        self._changed = changed
        self.latched = latched
        self.state = State.UNCONFIGURED
        self.reason = 'not configured yet'

    def configure(self, reason: str = 'configured') -> None:
        """UNCONFIGURED -> IDLE, or back to the fault that is latched."""
        self._from('configure', State.UNCONFIGURED)
        if self.latched:
            self._go(self.latched.after, f'still latched: {self.latched.reason}')
        else:
            self._go(State.IDLE, reason)

    def unconfigure(self, reason: str = 'cleaned up') -> None:
        """Any -> UNCONFIGURED; a latched fault is kept."""
        if self.state is not State.UNCONFIGURED:
            self._go(State.UNCONFIGURED, reason)

    def arm(self, reason: str = 'armed') -> None:
        """IDLE -> ARMED."""
        self._from('arm', State.IDLE)
        self._go(State.ARMED, reason)

    def activate(self, reason: str = 'every strut has a fresh command') -> None:
        """ARMED -> ACTIVE."""
        self._from('activate', State.ARMED)
        self._go(State.ACTIVE, reason)

    def stop(self, reason: str = 'stopped') -> None:
        """ARMED, ACTIVE -> IDLE; elsewhere nothing."""
        if self.state in {State.ARMED, State.ACTIVE}:
            self._go(State.IDLE, reason)

    def fault(self, reason: str) -> None:
        """IDLE, ARMED, ACTIVE -> FAULT; the first reason is kept."""
        if self.state in {State.IDLE, State.ARMED, State.ACTIVE}:
            self._latch(State.FAULT, reason)

    def estop(self, reason: str = 'emergency stop') -> None:
        """Any but UNCONFIGURED -> ESTOP; the first reason is kept."""
        if self.state not in {State.UNCONFIGURED, State.ESTOP}:
            self._latch(State.ESTOP, reason)

    def reset(self, reason: str = 'reset') -> None:
        """FAULT, ESTOP -> IDLE."""
        self._from('reset', *_LATCHED)
        self.latched = None
        self._go(State.IDLE, reason)

    def _latch(self, state: State, reason: str) -> None:
        self.latched = Transition(self.state, state, reason)
        self._go(state, reason)

    def _from(self, what: str, *allowed: State) -> None:
        if self.state not in allowed:
            names = ' or '.join(state.name for state in sorted(allowed, key=lambda s: s.value))
            raise SatvibError(
                f'{what}: refused in {self.state.name} ({self.reason}); possible in {names}'
            )

    def _go(self, state: State, reason: str) -> None:
        transition = Transition(self.state, state, reason)
        self.state, self.reason = state, reason
        self._changed(transition)
