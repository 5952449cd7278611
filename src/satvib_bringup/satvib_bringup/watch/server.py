# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The web server of the page: files, and one WebSocket for each page that is open.

It answers this machine alone: it is bound to 127.0.0.1, a request that names another host is refused (a foreign name
that leads here, "DNS rebinding"), and so is a WebSocket that a page of another origin opens. Commands come over the
WebSocket only, so no form and no link of another page can give one. Nothing that comes in is ever evaluated.
"""

import contextlib
import json
import socket
from asyncio import Future
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application, RequestHandler, StaticFileHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

HOST, PORT = '127.0.0.1', 8421
PAGE = Path(__file__).resolve().parent / 'page'
_LARGEST = 64 * 1024  # bytes of a message from a page
_OWN_NAMES = r'(127\.0\.0\.1|localhost)'

Command = Callable[[Mapping[str, Any], 'LivePage'], Awaitable[None]]


def _protect(handler: RequestHandler) -> None:
    """Only what this server has sent counts in its page, and no other page may frame it."""
    handler.set_header(
        'Content-Security-Policy',
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
        "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    )
    handler.set_header('X-Content-Type-Options', 'nosniff')
    handler.set_header('Referrer-Policy', 'no-referrer')
    handler.set_header('Cache-Control', 'no-cache')
    handler.clear_header('Server')


class PageFile(StaticFileHandler):
    """The files of the page. StaticFileHandler refuses paths that leave their folder."""

    def set_default_headers(self) -> None:
        """Protect."""
        _protect(self)


class LivePage(WebSocketHandler):
    """One page that is open. Tornado refuses an Origin that is not the Host of the request."""

    def initialize(
        self, pages: 'Pages', command: Command, whole: Callable[[], Mapping[str, Any]]
    ) -> None:
        """Take what every page needs."""
        self._pages, self._command, self._whole = pages, command, whole
        self._sending: Future[None] | None = None
        self._behind = False

    def open(self, *_: str, **__: str) -> None:
        """Send what is known so far."""
        self.set_nodelay(True)
        self.tell(self._whole())
        self._pages.open.add(self)

    def on_close(self) -> None:
        """The page was closed."""
        self._pages.open.discard(self)

    async def on_message(self, message: str | bytes) -> None:
        """Take a command: an object with the key `do`."""
        try:
            request = json.loads(message)
        except ValueError:
            request = None
        if not isinstance(request, dict) or not isinstance(request.get('do'), str):
            self.close(1007, 'not a command')
            return
        await self._command(request, self)

    def tell(self, message: Mapping[str, Any]) -> None:
        """Send to this page, unless it has gone meanwhile."""
        self._send(json.dumps(message, allow_nan=False))

    def tell_news(self, text: str) -> None:
        """Send what is new; a page that has not taken the last news yet gets everything when it has.

        So a browser that is too slow, or has been put to sleep, never makes this process keep its messages.
        """
        if self._sending is not None and not self._sending.done():
            self._behind = True
        elif self._behind:
            self._behind = False
            self.tell(self._whole())
        else:
            self._send(text)

    def _send(self, text: str) -> None:
        try:
            self._sending = self.write_message(text)
        except WebSocketClosedError:
            self._pages.open.discard(self)
            return
        self._sending.add_done_callback(_forget)


def _forget(sent: 'Future[None]') -> None:
    """A page that has gone is forgotten when its connection closes."""
    if not sent.cancelled():
        sent.exception()


class Pages:
    """The pages that are open, and the server that they come from."""

    def __init__(self, server: HTTPServer, port: int) -> None:
        self.server, self.port = server, port
        self.open: set[LivePage] = set()

    @property
    def address(self) -> str:
        """What to type into a browser."""
        return f'http://{HOST}:{self.port}'

    def tell(self, message: Mapping[str, Any]) -> None:
        """Send to all of them."""
        text = json.dumps(message, allow_nan=False)
        for page in list(self.open):
            page.tell_news(text)

    async def close(self) -> None:
        """Close all pages and end the server."""
        self.server.stop()
        for page in list(self.open):
            page.close(1001, 'satvib watch has ended')
        await self.server.close_all_connections()


def serve(port: int | None, command: Command, whole: Callable[[], Mapping[str, Any]]) -> Pages:
    """Begin to serve; inside a running event loop.

    Args:
        port: 0: any that is free; None: the usual one, or another when that is in use.
        command: called with a request and the page that it came from.
        whole: gives the first message to a page.

    Raises:
        SatvibError: the port is in use or not allowed.
    """
    sockets = _bound(port)
    application = Application(
        websocket_max_message_size=_LARGEST, websocket_ping_interval=20, log_function=_say_nothing
    )
    server = HTTPServer(application, max_body_size=_LARGEST)
    pages = Pages(server, sockets[0].getsockname()[1])
    needs = {'pages': pages, 'command': command, 'whole': whole}
    # another host than these finds nothing
    application.add_handlers(
        _OWN_NAMES,
        [
            (r'/live', LivePage, needs),
            (r'/(.*)', PageFile, {'path': str(PAGE), 'default_filename': 'index.html'}),
        ],
    )
    server.add_sockets(sockets)
    return pages


def _bound(port: int | None) -> list[socket.socket]:
    if port is None:
        with contextlib.suppress(OSError):
            return bind_sockets(PORT, HOST)
    try:
        return bind_sockets(port or 0, HOST)
    except (OSError, OverflowError) as error:
        why = getattr(error, 'strerror', None) or error
        raise SatvibError(
            f'port {port}: cannot be used: {why}; name another with --port, 0 takes one that is free'
        ) from None


def _say_nothing(_: RequestHandler) -> None:
    """No line for each request."""
