# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A bridge with its guardian: from the channels file to samples, and back to 0 V.

Everything that the node does and that is not ROS. A thread reports that the guardian has sent something; `serve` then
reads it.
"""

import time
from collections.abc import Callable
from pathlib import Path

from satvib_common.files.yaml_file import load_yaml

from satvib_daq_bridge.bridge.bias import save_bias
from satvib_daq_bridge.bridge.bridge import Bridge, Published
from satvib_daq_bridge.bridge.readable_thread import ReadableThread
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.guardian.child_process import GuardianProcess
from satvib_daq_bridge.parameters import BridgeParameters
from satvib_daq_bridge.states import Transition

# s; a guardian sends its figures every half second, also when its device is silent
_HANGS = 3.0


class Session:
    """From `configure` to `cleanup`.

    Args:
        parameters: checked.
        report: called from a thread of its own when there is something to serve.
        changed: called with each change of state.
        latched: the fault that a session before this one has latched.

    Raises:
        SatvibError: channels, options or devices that are not right, named.
        RunError: the guardian does not start.

    Attributes:
        notes: lines for the log; the reader removes them.
    """

    def __init__(
        self,
        parameters: BridgeParameters,
        report: Callable[[], None],
        changed: Callable[[Transition], None],
        latched: Transition | None = None,
    ) -> None:
        self.parameters, self._report = parameters, report
        self.notes: list[str] = []
        path = Path(parameters.channels)
        data = load_yaml(path)
        channels = parse_channels(data, str(path))
        channels.check_rate(parameters.sample_rate)
        self._setup = {
            'channels': data,
            'where': str(path),
            'sample_rate': parameters.sample_rate,
            'command_timeout': parameters.max_age,
            'cpu': parameters.guardian_cpu,
            'priority': parameters.guardian_priority,
        }
        self.guardian: GuardianProcess | None = None
        self.bridge = Bridge(channels, parameters, self._send, changed, latched)
        self._learnt = False
        virtual = self._start()
        self.bridge.configured(virtual, time.monotonic())

    def serve(self) -> list[Published]:
        """Read all messages of the guardian, and check that it runs; gives the samples to publish."""
        found = []
        bridge = self.bridge
        if self.guardian is not None:
            while message := self.guardian.link.receive():
                self._received_at = time.monotonic()
                published = bridge.take(message, self._received_at)
                if published is not None:
                    found.append(published)
            self._thread.answer()
            if self.guardian.link.closed:
                if not bridge.over:
                    bridge.guardian_ended(self.guardian.how())
                self._stop_guardian()
            elif time.monotonic() - self._received_at > _HANGS:
                bridge.guardian_ended(f'says nothing for {_HANGS:g} s and is replaced')
                self._thread.stop()
                self.guardian.zero_outputs()
                self.guardian = None
        bridge.tick(time.monotonic())
        if bridge.bias.learnt != self._learnt:
            self._learnt = bridge.bias.learnt
            if self._learnt:
                self._store()
        return found

    def reset(self) -> None:
        """FAULT, ESTOP -> IDLE; a guardian that ended is started again first.

        Raises:
            SatvibError: nothing to reset, or the devices still are not right.
        """
        if self.guardian is None:
            self._start()
            self.bridge.restarted(time.monotonic())
        self.bridge.reset()

    def close(self, reason: str) -> None:
        """End at 0 V."""
        self.bridge.states.stop(reason)
        self._stop_guardian()
        self.bridge.released(reason)

    def _start(self) -> bool:
        self.guardian = GuardianProcess(self._setup)
        found = self.guardian.found
        self.notes += [found['found'], *(f'guardian: {text}' for text in found['refused'])]
        self._received_at = time.monotonic()
        self._thread = ReadableThread(self.guardian.link.fileno(), self._report)
        self._thread.start()
        return bool(found['virtual'])

    def _store(self) -> None:
        self.notes.append('the bias of the sensors is learnt')
        if self.parameters.calibration_file:
            save_bias(Path(self.parameters.calibration_file), self.bridge.bias.to_mapping())

    def _stop_guardian(self) -> None:
        if self.guardian is not None:
            self._thread.stop()
            self.guardian.stop()
            self.guardian = None

    def _send(self, message: bytes) -> None:
        if self.guardian is not None:
            self.guardian.link.send(message)
