# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A real Chromium without a window, driven over its DevTools protocol."""

import asyncio
import base64
import contextlib
import json
import os
import queue
import re
import shutil
import signal
import subprocess
import threading
import urllib.request
from pathlib import Path
from typing import Any

from tornado.websocket import WebSocketClientConnection, websocket_connect

PROGRAMS = ('chromium-headless-shell', 'chromium', 'chromium-browser', 'google-chrome')
LIMIT = float(os.environ.get('SATVIB_TEST_LIMIT', '60'))  # s
LISTENING = re.compile(rb'DevTools listening on ws://[^/]+:(\d+)/')
# looks again whenever the page has changed; what is drawn comes with a change of the clock
WHEN = """new Promise((resolve) => {{
  const look = () => {{
    const value = {expression};
    if (value) {{ observer.disconnect(); resolve(value); }}
  }};
  const observer = new MutationObserver(look);
  observer.observe(document,
    {{ subtree: true, childList: true, attributes: true, characterData: true }});
  look();
}})"""


def program() -> str | None:
    """The browser of this machine; None where there is none."""
    return next((found for name in PROGRAMS if (found := shutil.which(name))), None)


class Browser:
    """A browser process; its pages are driven from any thread."""

    def __init__(self, folder: Path) -> None:
        command = [str(program()), '--headless', '--no-sandbox', '--disable-gpu']
        command += ['--remote-debugging-port=0', f'--user-data-dir={folder}', '--no-first-run']
        command += ['--disable-dev-shm-usage', 'about:blank']
        self.log = (folder.parent / 'browser.log').open('wb')
        # the program is a script that starts the browser: both end as one group
        self.popen = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True
        )
        ports: queue.SimpleQueue[int | None] = queue.SimpleQueue()
        self.listener = threading.Thread(target=self._listen, args=(ports,), daemon=True)
        self.listener.start()
        port = ports.get(timeout=LIMIT)
        assert port is not None, 'the browser has ended'
        self.port = port
        self.loop = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self.thread.start()

    def _listen(self, ports: 'queue.SimpleQueue[int | None]') -> None:
        """Write what it says into the log, and hand on its port."""
        assert self.popen.stdout is not None
        for line in self.popen.stdout:
            self.log.write(line)
            if found := LISTENING.search(line):
                ports.put(int(found[1]))
        ports.put(None)

    def open(self, address: str, width: int = 1280, height: int = 1000) -> 'Page':
        """Open a page in a new tab."""
        request = urllib.request.Request(
            f'http://127.0.0.1:{self.port}/json/new?about:blank', method='PUT'
        )
        with urllib.request.urlopen(request, timeout=LIMIT) as answer:
            target = json.load(answer)
        page = Page(self, target['webSocketDebuggerUrl'])
        size = {'width': width, 'height': height, 'deviceScaleFactor': 1, 'mobile': False}
        page.ask('Emulation.setDeviceMetricsOverride', **size)
        page.load(address)
        return page

    def close(self) -> None:
        """End it."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.popen.pid, signal.SIGKILL)
        self.popen.wait()
        self.listener.join(10)
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join(10)
        self.loop.close()
        self.log.close()


class Page:
    """One tab."""

    def __init__(self, browser: Browser, address: str) -> None:
        self._loop = browser.loop
        self._next = 0
        self._events: list[dict[str, Any]] = []
        self._socket: WebSocketClientConnection = self._run(self._connect(address))

    def _run(self, task: Any, limit: float = LIMIT) -> Any:
        future = asyncio.run_coroutine_threadsafe(task, self._loop)
        try:
            return future.result(limit)
        except TimeoutError:
            future.cancel()
            raise

    @staticmethod
    async def _connect(address: str) -> WebSocketClientConnection:
        return await websocket_connect(address, max_message_size=100_000_000)

    def ask(self, method: str, limit: float = LIMIT, /, **parameters: Any) -> Any:
        """Call a method of the DevTools protocol."""
        return self._run(self._ask(method, parameters), limit)

    async def _ask(self, method: str, parameters: dict[str, Any]) -> Any:
        self._next += 1
        number = self._next
        request = {'id': number, 'method': method, 'params': parameters}
        await self._socket.write_message(json.dumps(request))
        while (answer := await self._read()).get('id') != number:
            self._events.append(answer)
        assert 'error' not in answer, answer
        return answer['result']

    async def _read(self) -> dict[str, Any]:
        message = await self._socket.read_message()
        assert message is not None, 'the browser has closed the page'
        return json.loads(message)

    def load(self, address: str) -> None:
        """Go to an address; return when all of it is loaded."""
        self.ask('Page.enable')
        self.ask('Page.setLifecycleEventsEnabled', enabled=True)
        loader = self.ask('Page.navigate', url=address)['loaderId']
        self._run(self._loaded(loader))
        self.ask('Page.disable')
        self._events.clear()

    async def _loaded(self, loader: str) -> None:
        wanted = {'name': 'load', 'loaderId': loader}
        while not any(wanted.items() <= e.get('params', {}).items() for e in self._events):
            self._events.append(await self._read())

    def evaluate(self, expression: str, limit: float = LIMIT) -> Any:
        """Value of an expression in the page; that of a promise, when it has one."""
        found = self.ask(
            'Runtime.evaluate', limit, expression=expression, returnByValue=True, awaitPromise=True
        )
        assert 'exceptionDetails' not in found, found
        return found['result'].get('value')

    def wait(self, expression: str, limit: float = LIMIT) -> Any:
        """Wait until an expression is true in the page; gives its value."""
        try:
            return self.evaluate(WHEN.format(expression=expression), limit)
        except TimeoutError:
            raise AssertionError(f'waited in vain for {expression}') from None

    def screenshot(self, path: Path, **clip: float) -> None:
        """Write what the page shows to a PNG file; clip: x, y, width, height of a part."""
        options: dict[str, Any] = {'format': 'png'}
        if clip:
            options['clip'] = clip | {'scale': 1}
        data = self.ask('Page.captureScreenshot', **options)['data']
        path.write_bytes(base64.b64decode(data))

    def heap(self) -> int:
        """Bytes that the page's scripts use, after a collection."""
        self.ask('HeapProfiler.collectGarbage')
        return int(self.ask('Runtime.getHeapUsage')['usedSize'])

    def close(self) -> None:
        """Close the tab."""
        self.ask('Page.close')
