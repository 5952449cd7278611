# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The server of the page: what it gives out, and what it refuses. Truth: HTTP, and a list of forged requests."""

import asyncio
import hashlib
import json
import socket
from collections.abc import Callable, Coroutine
from typing import Any

import pytest
from satvib_bringup.watch.server import PAGE, Pages, serve
from satvib_common.errors import SatvibError
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

Talk = Callable[[Pages, list[Any]], Coroutine[Any, Any, None]]


def with_server(talk: Talk) -> list[Any]:
    """Serve while a test talks to it; gives the commands that have arrived."""
    commands: list[Any] = []

    async def command(request: Any, page: Any) -> None:
        commands.append(request)
        page.tell({'kind': 'taken'})

    async def go() -> None:
        pages = serve(0, command, lambda: {'kind': 'whole'})
        try:
            await talk(pages, commands)
        finally:
            await pages.close()

    asyncio.run(go())
    return commands


async def status(pages: Pages, path: str, method: str = 'GET', **headers: str) -> int:
    """Status of a request as it is typed; clients would tidy the path first."""
    reader, writer = await asyncio.open_connection('127.0.0.1', pages.port)
    sent = {'Host': f'127.0.0.1:{pages.port}', 'Connection': 'close'} | headers
    lines = [f'{method} {path} HTTP/1.1', *(f'{k}: {v}' for k, v in sent.items()), '', '']
    writer.write('\r\n'.join(lines).encode())
    line = await reader.readline()
    writer.close()
    return int(line.split()[1])


def test_it_listens_to_this_machine_alone():
    """The address that it is bound to."""

    async def talk(pages: Pages, _: Any) -> None:
        (bound,) = pages.server._sockets.values()
        assert bound.getsockname()[0] == '127.0.0.1'

    with_server(talk)


def test_every_file_of_the_page_is_served_from_here_and_protected():
    """The page names local files only, and its headers forbid all others."""

    async def talk(pages: Pages, _: Any) -> None:
        client = AsyncHTTPClient()
        for path in ('/', '/watch.js', '/watch.css', '/vendor/uPlot.iife.min.js'):
            answer = await client.fetch(f'{pages.address}{path}')
            assert "default-src 'none'" in answer.headers['Content-Security-Policy']
            assert "frame-ancestors 'none'" in answer.headers['Content-Security-Policy']
            assert answer.headers['X-Content-Type-Options'] == 'nosniff'
        text = (PAGE / 'index.html').read_text()
        assert 'http:' not in text
        assert 'https:' not in text

    with_server(talk)


@pytest.mark.parametrize(
    'host', ['evil.example', 'evil.example:8421', '127.0.0.1.evil.example', '']
)
def test_a_foreign_name_of_this_machine_finds_nothing(host):
    """DNS rebinding: another name leads to this port."""

    async def talk(pages: Pages, _: Any) -> None:
        assert await status(pages, '/', Host=host) in {400, 404}
        assert await status(pages, '/live', Host=host) in {400, 404}

    with_server(talk)


@pytest.mark.parametrize(
    'path',
    ['/../server.py', '/vendor/../../server.py', '/%2e%2e/server.py', '//etc/passwd',
     '/..%2f..%2fserver.py', '/vendor/%2e%2e/%2e%2e/strut.py', '/\\..\\server.py'],
)  # fmt: skip
def test_no_path_leaves_the_folder_of_the_page(path):
    """Path traversal."""

    async def talk(pages: Pages, _: Any) -> None:
        assert await status(pages, path) in {400, 403, 404}

    with_server(talk)


@pytest.mark.parametrize('method', ['POST', 'PUT', 'DELETE', 'PATCH'])
def test_nothing_is_commanded_by_a_request(method):
    """Cross-site request forgery: forms and links of other pages can make such requests."""

    async def talk(pages: Pages, commands: list[Any]) -> None:
        for path in ('/', '/live'):
            assert await status(pages, path, method, **{'Content-Length': '0'}) >= 400
        assert commands == []

    with_server(talk)


@pytest.mark.parametrize(
    'origin', ['http://evil.example', 'null', 'http://127.0.0.1:1', 'https://127.0.0.1']
)
def test_a_page_of_another_origin_gets_no_socket(origin):
    """Browsers send the Origin of the page that opens a WebSocket."""

    async def talk(pages: Pages, _: Any) -> None:
        request = HTTPRequest(f'ws://127.0.0.1:{pages.port}/live', headers={'Origin': origin})
        with pytest.raises(HTTPClientError) as refused:
            await websocket_connect(request)
        assert refused.value.code == 403

    with_server(talk)


def test_its_own_page_gets_the_whole_and_may_command():
    """The Origin of the page is the Host of the server."""

    async def talk(pages: Pages, _: Any) -> None:
        request = HTTPRequest(
            f'ws://127.0.0.1:{pages.port}/live', headers={'Origin': pages.address}
        )
        client = await websocket_connect(request)
        assert json.loads(await client.read_message()) == {'kind': 'whole'}
        await client.write_message('{"do": "stop"}')
        assert json.loads(await client.read_message()) == {'kind': 'taken'}

    assert with_server(talk) == [{'do': 'stop'}]


@pytest.mark.parametrize(
    'text', ['', '{', '[]', '7', '{"do": 1}', '{"dont": "stop"}', '\x00', 'null']
)
def test_what_is_no_command_ends_that_page_alone(text):
    """Another page goes on."""

    async def talk(pages: Pages, _: Any) -> None:
        address = f'ws://127.0.0.1:{pages.port}/live'
        odd, other = await websocket_connect(address), await websocket_connect(address)
        for client in (odd, other):
            await client.read_message()
        await odd.write_message(text)
        assert await odd.read_message() is None
        await other.write_message('{"do": "reset"}')
        assert json.loads(await other.read_message()) == {'kind': 'taken'}

    assert with_server(talk) == [{'do': 'reset'}]


def test_a_page_that_takes_nothing_costs_no_memory_and_gets_everything_later():
    """Truth: 200 MB of news for a page that does not read; what waits stays below 8 MB, and the next is the whole."""

    async def talk(pages: Pages, _: Any) -> None:
        reader, writer = await asyncio.open_connection('127.0.0.1', pages.port, limit=1024)
        lines = ['GET /live HTTP/1.1', f'Host: 127.0.0.1:{pages.port}', 'Upgrade: websocket', 'Connection: Upgrade',
                 'Sec-WebSocket-Version: 13', 'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==', '', '']  # fmt: skip
        writer.write('\r\n'.join(lines).encode())
        await reader.readuntil(b'\r\n\r\n')
        assert b'"whole"' in await reader.readuntil(b'}')
        (page,) = pages.open
        portion = {'kind': 'news', 'text': 'x' * 1_000_000}
        most = 0
        for _ in range(200):
            pages.tell(portion)
            await asyncio.sleep(0)
            most = max(most, len(page.ws_connection.stream._write_buffer))
        assert most < 8_000_000
        taken = b''
        while b'"whole"' not in taken:
            taken = (taken + await asyncio.wait_for(reader.read(65536), 30.0))[-200_000:]
            pages.tell({'kind': 'news'})
        writer.close()

    with_server(talk)


def test_a_port_that_is_taken_is_one_line():
    """Truth: a socket that listens there."""
    with socket.create_server(('127.0.0.1', 0)) as taken:
        port = taken.getsockname()[1]

        async def go() -> None:
            serve(port, None, dict)

        with pytest.raises(
            SatvibError, match=f'port {port}: cannot be used: Address already in use'
        ):
            asyncio.run(go())


def test_the_usual_port_is_left_to_who_has_it():
    """Truth: the operating system. Two servers without a wanted port have two addresses."""

    async def go() -> None:
        first, second = serve(None, None, dict), serve(None, None, dict)
        try:
            assert first.port != second.port
        finally:
            await first.close()
            await second.close()

    asyncio.run(go())


def test_the_library_of_the_page_is_the_published_one():
    """Truth: the hash of the file in the package uplot 1.6.32 of the npm registry."""
    found = hashlib.sha256((PAGE / 'vendor' / 'uPlot.iife.min.js').read_bytes()).hexdigest()
    assert found == '19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f'
    found = hashlib.sha256((PAGE / 'vendor' / 'uPlot.min.css').read_bytes()).hexdigest()
    assert found == 'df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04'
