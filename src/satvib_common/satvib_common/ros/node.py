# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The base of every satvib node: a lifecycle node whose parameters are one schema.

    unconfigured --`configure`--> inactive --`activate`--> active
                 <---`cleanup`---          <-`deactivate`-

A subclass builds its core and its publishers in `configure`, and its subscriptions in `activate`. So an inactive node
costs nothing, and a node that is activated late still receives everything. With `autostart` (the default) a node
activates itself. A node is alone in its process, or shares it with others; it is made at its place (`place`), and its
messages go through `delivery`, so that no node needs to know.

Every end of a node goes through `finish`, which sets the exit code and the last line of the process. Callbacks are
registered through `guarded`: a `SatvibError` or `RunError` in a callback ends the process with that one line and no
traceback.
"""

from collections.abc import Callable
from typing import Any, Generic, TypeVar

from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, ClockType
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rclpy.timer import Timer
from std_srvs.srv import Trigger

from satvib_common.errors import RunError, SatvibError
from satvib_common.ros.delivery.endpoints import Input, Output
from satvib_common.ros.names import shared, strut_of
from satvib_common.ros.parameters import NodeParameters
from satvib_common.ros.place import place_of_node
from satvib_common.ros.qos import offered, overridable
from satvib_common.ros.reporting import Reporting
from satvib_common.schema import Schema

P = TypeVar('P', bound=Schema)

# s, how long a node that is told to stop still works on what it has received
DRAIN = 10.0


class SatvibNode(LifecycleNode, Generic[P]):  # type: ignore[misc]
    """A node that is one schema of parameters, a core, and messages in and out.

    Args:
        name: of the node.
        schema: of its parameters.

    Raises:
        SatvibError: parameters that are wrong.
    """

    # who goes first where a process or a processor is shared: 0 plant and controllers, 1 identifiers, 2 recorder
    rank = 0

    def __init__(self, name: str, schema: type[P]) -> None:
        place = place_of_node()
        self._exchange = place.exchange
        super().__init__(name, **place.options)
        self.ended = False
        self.exit_code = 0
        self.last_line = ''
        self.wake: Callable[[], None] = lambda: (
            None
        )  # ends the turn of the main loop that is under way
        self.configured = False
        self.active = False
        self.handled = 0
        self.failure: Exception | None = None
        self._readers: list[Input] = []
        self._writers: list[Output] = []
        self._timers_made: list[Timer] = []
        self._services_made: list[Any] = []
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.autostart = bool(self.declare_parameter('autostart', True).value)
        self._settings = NodeParameters(self, schema, self._settings_changed)
        # as the parameter says, until the samples say it (`loop.pace`)
        self.in_lockstep = bool(getattr(self.parameters, 'lockstep', False))

    # ---- what a subclass fills in

    def configure(self) -> None:
        """Build the core and the publishers from `self.parameters`."""

    def activate(self) -> None:
        """Make the subscriptions and start."""

    def deactivate(self) -> None:
        """Come to rest. Publishing is still possible."""

    def cleanup(self) -> None:
        """Release what `configure` built."""

    def changed(self, parameters: P) -> None:
        """Take a new, valid set of parameters."""

    def effect_of(self, _names: frozenset[str]) -> str:
        """Say what people should know about the parameters that were just `changed`; empty: they act as set."""
        return ''

    def stop(self) -> str:
        """Come to a safe state and stay there; gives what was done."""
        return 'nothing to stop'

    def reset(self) -> str:
        """Release latched faults and start again; gives what was done."""
        return 'nothing to reset'

    def diagnose(self) -> tuple[str, dict[str, Any]]:
        """Give a complaint (empty when there is none) and figures for people."""
        return '', {}

    def awaits(self) -> str:
        """What the node cannot go on without and has not got, as the end of "waits for ..."; empty: nothing."""
        return ''

    def report_state(self) -> None:
        """Publish the state on /diagnostics."""
        reporting = self.reporting
        complaint, figures = self.diagnose()
        if (rivals := reporting.rivals()) not in complaint:
            complaint = '; '.join(filter(None, (complaint, rivals)))
        if not complaint and (awaited := reporting.awaited()):
            complaint = f'waits for {awaited}'
        figures |= reporting.connections()
        reporting.diagnostics.publish(self.active, complaint, figures, failed=self.is_at_fault())

    def is_at_fault(self) -> bool:
        """Whether the complaint is a fault: an ERROR on /diagnostics, not a WARN."""
        return False

    def tick(self) -> float:
        """Do what is due by the steady clock; gives how long the loop may wait, in s."""
        return 0.1

    def pause(self) -> float:
        """How long messages may gather before they are worked on, in s; 0: at once.

        A message that wakes a process costs 50-100 us, one of a heap 5 us.
        """
        return 0.0

    # ---- what a subclass uses

    @property
    def parameters(self) -> P:
        """The parameters in force."""
        return self._settings.value

    @property
    def strut(self) -> str:
        """Name of the strut whose namespace this is."""
        return strut_of(self.get_namespace())

    def shared(self, topic: str) -> str:
        """Name of a topic that all struts share."""
        return shared(self.get_namespace(), topic)

    def publish_on(
        self, kind: Any, topic: str, qos: QoSProfile | None = None, spared: bool = False
    ) -> Output:
        """Make a publisher that lives until `cleanup`; a spared one sends nothing while nobody reads it."""
        paced = qos is None and bool(getattr(self.parameters, 'lockstep', False))
        publisher = self.create_lifecycle_publisher(
            kind, topic, qos or offered(paced=paced), qos_overriding_options=overridable()
        )
        given_up = (lambda: self.ended or not self.in_lockstep) if paced else None
        self._writers.append(Output(publisher, self._exchange, spared, given_up))
        return self._writers[-1]

    def listen_to(
        self,
        kind: Any,
        topic: str,
        callback: Callable[[Any], None],
        qos: QoSProfile,
        raw: bool = False,
    ) -> Input:
        """Make a subscription that lives while the node is active; `raw`: of serialized messages."""
        call = self.guarded(callback)
        reader = Input(self, self._exchange, kind, topic, call, qos, self.rank, raw)
        self._readers.append(reader)
        return reader

    def forget(self, reader: Input) -> None:
        """End a subscription early, if it is still there."""
        if reader in self._readers:
            self._readers.remove(reader)
            reader.close()

    def every(self, period: float, callback: Callable[[], None]) -> Timer:
        """Call back every `period` s of the steady clock while the node is configured."""
        guarded = self.guarded_call(callback)
        # what a timer has set off may come when it, and what it uses, has been destroyed
        timer: Timer = self.create_timer(
            period, lambda: guarded() if timer in self._timers_made else None, clock=self._steady
        )
        self._timers_made.append(timer)
        return timer

    def offer(self, what: str) -> None:
        """Offer ~/`what` as a Trigger that calls the method of that name while the node is configured."""
        made = self.create_service(Trigger, f'~/{what}', self._on_trigger(what))
        self._services_made.append(made)

    def guarded(self, callback: Callable[[Any], None]) -> Callable[[Any], None]:
        """Turn the errors that people see into the end of the process."""

        def call(message: Any) -> None:
            self.handled += 1
            try:
                callback(message)
            except (SatvibError, RunError) as error:
                self.fail(error)
            if exchange is not None:
                exchange.first()

        exchange = self._exchange
        return call

    def guarded_call(self, callback: Callable[[], None]) -> Callable[[], None]:
        """Guard a callback without a message in the same way."""

        def call() -> None:
            try:
                callback()
            except (SatvibError, RunError) as error:
                self.fail(error)
            if exchange is not None:
                exchange.first()

        exchange = self._exchange
        return call

    def finish(self, line: str = '', code: int = 0) -> None:
        """End the process; the first reason given is the one that is shown."""
        if not self.ended:
            self.ended = True
            self.exit_code = code
            self.last_line = line
            self.wake()

    def interrupt(self) -> None:
        """End the process, asked by a signal: the main loop sees it at the end of its slice.

        The main thread, which the signal interrupts, may hold the very lock that `wake` would take.
        """
        self.ended = True

    def fail(self, error: Exception) -> None:
        """End the process with an error: 2 for what people must correct, 1 for a run that failed."""
        self.finish(str(error), 2 if isinstance(error, SatvibError) else 1)

    def sources_left(self) -> bool:
        """Whether any node of another process still publishes what this node reads."""
        return any(r.get_publisher_count() > 0 for r in self._readers if not r.is_local())

    def writers(self) -> list[Output]:
        """Publishers whose messages should arrive before the process ends."""
        return self._writers

    def readers(self) -> list[Input]:
        """Subscriptions of now."""
        return self._readers

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """As rclpy does; a refusal says why, a misspelt name what may be meant, a change what it does."""
        refused = self._settings.unknown_of(self, parameter_list)
        result = refused or super().set_parameters_atomically(parameter_list)
        return self._settings.explain(result, parameter_list)

    # ---- lifecycle

    def configure_now(self) -> None:
        """Configure; `autostart` asks for it.

        Raises:
            SatvibError, RunError: what `configure` raised.
        """
        self._go(self.trigger_configure)

    def activate_now(self) -> None:
        """Activate; `autostart` asks for it.

        Raises:
            SatvibError, RunError: what `activate` raised.
        """
        self._go(self.trigger_activate)

    def _go(self, transition: Callable[[], TransitionCallbackReturn]) -> None:
        if transition() != TransitionCallbackReturn.SUCCESS:
            raise self.failure or RunError(f'{self.get_name()}: could not be started')

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Build."""
        result = self._transition(self._build, super().on_configure, state)
        if result == TransitionCallbackReturn.FAILURE:
            self._release()
        return result

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Start. Publishers are active first, so `activate` may publish."""
        result = super().on_activate(state)
        if result != TransitionCallbackReturn.SUCCESS:
            return result
        self.active = True
        return self._transition(self.activate, None, state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Come to rest. Publishers become inactive last."""
        return self._transition(self._rest, super().on_deactivate, state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Release everything."""
        return self._transition(self._release, super().on_cleanup, state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Come to rest, release everything and end the process."""
        if self.active:
            self._transition(self._rest, super().on_deactivate, state)
        result = self._transition(self._release, super().on_shutdown, state)
        self.finish('shut down')
        return result

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Return to unconfigured, so that `configure` can be tried again."""
        self.active = False
        self._release()
        return super().on_error(state)

    def _transition(
        self, act: Callable[[], None], then: Callable[[Any], Any] | None, state: LifecycleState
    ) -> TransitionCallbackReturn:
        try:
            act()
        except (SatvibError, RunError) as error:
            self.failure = error
            self.active = False
            if not self.autostart:
                self.get_logger().error(str(error))
            return TransitionCallbackReturn.FAILURE
        except Exception as error:
            # rclpy does not pass it on: keep it for `start`, and log it when a tool asked for the transition
            self.failure = error
            if not self.autostart:
                self.get_logger().error(f'{type(error).__name__}: {error}')
            raise
        return then(state) if then else TransitionCallbackReturn.SUCCESS

    def _build(self) -> None:
        self.configure()
        self.configured = True
        self.offer('stop')
        self.offer('reset')
        self.reporting = Reporting(self)

    def _rest(self) -> None:
        if self.active:
            self.deactivate()
        self.active = False
        for reader in self._readers:
            reader.close()
        self._readers.clear()

    def _release(self) -> None:
        if self.configured:
            self.cleanup()
            self.reporting.diagnostics.close()
        self.configured = False
        for timer in self._timers_made:
            self.destroy_timer(timer)
        for service in self._services_made:
            self.destroy_service(service)
        for writer in self._writers:
            writer.close()
            self.destroy_lifecycle_publisher(writer.publisher)
        for made in (self._timers_made, self._services_made, self._writers):
            made.clear()

    def _on_trigger(self, what: str) -> Callable[[Any, Any], Any]:
        def answer(_: Any, response: Any) -> Any:
            response.success = self.active
            try:
                response.message = (
                    getattr(self, what)() if self.active else 'the node is not active'
                )
            except (SatvibError, RunError) as error:
                response.success, response.message = False, str(error)
            self.get_logger().info(f'{what}: {response.message}')
            return response

        return answer

    def _settings_changed(self, parameters: P, names: frozenset[str]) -> str:
        if self.configured:
            self.changed(parameters)
        return self.effect_of(names) if self.configured else ''
