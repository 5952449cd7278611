# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A serial port that never waits: bytes in, bytes out, and what is still unsent."""

import os
import select
import time
from typing import Any

from satvib_common.errors import SatvibError

from satvib_daq_bridge.back_ends.base import BackEndError, missing_library

# bytes of one read; the rest is read in the next turn, so that a flood never delays a voltage or its expiry
PORTION = 2048


class Port:
    """One port.

    Args:
        path: of the port.
        baud: rate of a UART.
    """

    def __init__(self, path: str, baud: int) -> None:
        self.path, self._baud = path, baud
        self._port: Any = None
        self._unsent = b''

    def open(self) -> None:
        """Open the port.

        Raises:
            SatvibError: it cannot be opened, or pyserial is missing.
        """
        try:
            import serial
        except ImportError:
            raise missing_library('serial', 'pyserial', 'pip install pyserial') from None
        try:
            self._port = serial.Serial(
                self.path, self._baud, timeout=0, write_timeout=0, exclusive=True
            )
        except (OSError, ValueError) as error:
            raise SatvibError(
                f'{self.path}: the port cannot be opened: {error}; is the device plugged in, the port '
                "free, and are you in the group 'dialout'?"
            ) from None

    @property
    def is_open(self) -> bool:
        """Whether the port is open."""
        return self._port is not None

    def fileno(self) -> int:
        """The descriptor; -1 when the port is closed."""
        return -1 if self._port is None else int(self._port.fileno())

    def close(self) -> None:
        """Close the port."""
        self._port.close()
        self._port = None

    def read(self) -> bytes:
        """Give bytes that have arrived, at most `PORTION`; never waits.

        Raises:
            BackEndError: the device is unplugged.
        """
        try:
            data = os.read(self.fileno(), PORTION)
        except BlockingIOError:
            return b''
        except OSError as error:
            raise BackEndError(f'{self.path}: the line is gone: {error.strerror}') from None
        if not data and self._hung_up():
            raise BackEndError(f'{self.path}: the line is gone: unplugged')
        return data

    def offer(self, data: bytes) -> bool:
        """Begin to send when nothing older is unsent; gives whether it began."""
        self.flush()
        if self._unsent:
            return False
        self._unsent = data
        self.flush()
        return True

    def send_all(self, data: bytes, patience: float = 1.0) -> None:
        """Send all bytes, waiting for at most `patience` s; not for use while samples flow.

        Raises:
            BackEndError: the port did not take them in that time.
        """
        self._unsent += data
        deadline = time.monotonic() + patience
        while self._unsent:
            self.flush()
            left = deadline - time.monotonic()
            if self._unsent and (
                left <= 0.0 or not select.select([], [self.fileno()], [], left)[1]
            ):
                raise BackEndError(f'{self.path}: the line takes nothing')

    def flush(self) -> None:
        """Send what the port takes now."""
        if not self._unsent:
            return
        try:
            written = os.write(self.fileno(), self._unsent)
        except BlockingIOError:
            return
        except OSError as error:
            raise BackEndError(f'{self.path}: the line is gone: {error.strerror}') from None
        self._unsent = self._unsent[written:]

    def _hung_up(self) -> bool:
        """Whether the other end is gone; an empty read alone does not say it."""
        poller = select.poll()
        poller.register(self.fileno(), select.POLLIN)
        gone = select.POLLHUP | select.POLLERR | select.POLLNVAL
        return any(events & gone for _, events in poller.poll(0))
