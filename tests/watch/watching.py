# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The page's server as a process, and a page without a browser."""

import asyncio
import json
import os
import queue
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

from tornado.websocket import WebSocketClientConnection, websocket_connect

LIMIT = float(os.environ.get('SATVIB_TEST_LIMIT', '60'))  # s


def found_in(stream: IO[bytes], pattern: bytes, log: Path) -> str:
    """The first match in what a process says, waited for; all that it says goes into a file, to its end."""
    lines: queue.Queue[bytes] = queue.Queue()

    def read() -> None:
        with log.open('wb') as sink:
            for line in stream:
                sink.write(line)
                sink.flush()
                lines.put(line)

    threading.Thread(target=read, daemon=True).start()
    while not (match := re.search(pattern, lines.get(timeout=LIMIT))):
        pass
    return match[0].decode()


class Watch:
    """`satvib watch`, as a person starts it."""

    def __init__(self, folder: Path) -> None:
        from satvib_bringup.live.workspace import graph_environment

        self.folder = folder
        command = [sys.executable, '-m', 'satvib_bringup.cli.main', 'watch', '--port', '0']
        self.log = (folder / 'watch.log').open('wb')
        self.popen = subprocess.Popen(
            [*command, '--folder', str(folder / 'runs')],
            stdout=subprocess.PIPE,
            stderr=self.log,
            env=graph_environment(),
        )
        assert self.popen.stdout is not None
        self.address = self.popen.stdout.readline().decode().strip()

    def end(self, number: signal.Signals = signal.SIGINT) -> int:
        """Exit code after a signal."""
        if self.popen.poll() is None:
            self.popen.send_signal(number)
        try:
            return self.popen.wait(LIMIT)
        finally:
            self.popen.kill()
            self.popen.wait()
            self.log.close()
            print((self.folder / 'watch.log').read_text())


class Client:
    """A page without a browser: the newest of everything that the server has sent.

    Attributes:
        struts: by name, their newest message.
        lines: what was said, oldest first.
        nodes: by name.
        parameters: the newest answer.
    """

    def __init__(self, address: str) -> None:
        self.struts: dict[str, Any] = {}
        self.nodes: dict[str, Any] = {}
        self.lines: list[str] = []
        self.newest: dict[str, Any] = {}
        self.parameters: dict[str, Any] | None = None
        self.messages = 0
        self.closed = False
        self._news = threading.Condition()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        connecting = self._connect(f'ws{address.removeprefix("http")}/live')
        self._socket = asyncio.run_coroutine_threadsafe(connecting, self._loop).result(LIMIT)
        self._reading = asyncio.run_coroutine_threadsafe(self._read(), self._loop)

    @staticmethod
    async def _connect(address: str) -> WebSocketClientConnection:
        return await websocket_connect(address, max_message_size=2**24)

    async def _read(self) -> None:
        while (text := await self._socket.read_message()) is not None:
            with self._news:
                self._take(json.loads(text))
                self._news.notify_all()
        with self._news:
            self.closed = True
            self._news.notify_all()

    def _take(self, message: dict[str, Any]) -> None:
        if message['kind'] == 'parameters':
            self.parameters = message
        else:
            self.newest = message
            self.struts |= {strut['name']: strut for strut in message['struts']}
            self.nodes = {node['name']: node for node in message['nodes']}
            self.lines += [line['text'] for line in message['lines']]
        self.messages += 1

    def send(self, **request: Any) -> None:
        """Give a command."""
        text = json.dumps(request)

        async def write() -> None:
            await self._socket.write_message(text)

        asyncio.run_coroutine_threadsafe(write(), self._loop).result(LIMIT)

    def wait(self, condition: Callable[[], Any], limit: float = LIMIT) -> Any:
        """Wait until a condition holds; gives what it gave."""
        with self._news:
            value = self._news.wait_for(condition, limit)
        assert value, f'waited in vain; said: {self.lines}'
        return value

    def said(self, *words: str) -> str:
        """The first line with all these words, waited for."""
        return self.wait(lambda: next((x for x in self.lines if all(w in x for w in words)), ''))

    def close(self) -> None:
        """Close it."""
        self._loop.call_soon_threadsafe(self._socket.close)
        self._reading.result(LIMIT)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(LIMIT)
        self._loop.close()
