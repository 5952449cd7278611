# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The process of `satvib watch`: one thread that hears the graph, answers pages, and steps back for the graph.

What has come from the graph is taken twenty times a second, whatever the rate of the loop, and goes to the pages five
times a second, once for all pages.
"""

import asyncio
import contextlib
import signal
import time
from collections.abc import Callable
from pathlib import Path

from satvib_common.errors import SatvibError
from satvib_common.realtime import set_niceness
from satvib_common.transport.reach import set_transport

from satvib_bringup.live.services.remote import Remote
from satvib_bringup.watch.graph import WatchedGraph
from satvib_bringup.watch.live.commands import Commands
from satvib_bringup.watch.live.listener import GraphListener
from satvib_bringup.watch.live.record import Recording
from satvib_bringup.watch.server import Pages, serve

NICENESS = 10  # the graph goes first
_TAKE, _SEND, _LOOK = 0.05, 0.2, 1.0  # s
_ANSWER = 0.01  # s, between two looks while somebody waits for a node's answer


def watch(port: int | None, folder: Path, ready: Callable[[str], None]) -> None:
    """Serve the page until SIGINT or SIGTERM.

    Args:
        port: 0: any that is free; None: the usual one, or another when that is in use.
        folder: under which recordings are kept.
        ready: called with the address of the page.

    Raises:
        SatvibError: the port cannot be used.
    """
    set_transport()
    graph = WatchedGraph()
    listener = GraphListener(graph)
    set_niceness(NICENESS)
    try:
        asyncio.run(_serve(port, folder, graph, listener, ready))
    finally:
        listener.close()


async def _serve(
    port: int | None,
    folder: Path,
    graph: WatchedGraph,
    listener: GraphListener,
    ready: Callable[[str], None],
) -> None:
    remote, recording = Remote(listener.node), Recording(folder)
    commands = Commands(graph, remote, recording)
    pages = serve(port, commands, graph.whole)
    end = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, end.set)
    ready(pages.address)
    try:
        await _work(graph, listener, commands, remote, recording, pages, end)
    finally:
        with contextlib.suppress(SatvibError):
            await recording.stop()
        await pages.close()


async def _work(
    graph: WatchedGraph, listener: GraphListener, commands: Commands, remote: Remote,
    recording: Recording, pages: Pages, end: asyncio.Event,
) -> None:  # fmt: skip
    send_at = look_at = 0.0
    while not end.is_set():
        listener.work()
        now = time.monotonic()
        if now >= look_at:
            look_at = now + _LOOK
            listener.look()
            graph.look()
            for node in {*commands.controllers(), *commands.plants()}:
                remote.prepare(node)
            graph.armable = any(remote.offers(node, 'arm') for node in commands.plants())
            for ending in recording.ended():
                graph.say(f'recording: {ending}', well=False)
        if now >= send_at:
            send_at = now + _SEND
            listener.collect()
            news = graph.news()
            news['changed'] = sorted(listener.changed)
            listener.changed.clear()
            if pages.open:
                pages.tell(news)
        await asyncio.sleep(_ANSWER if remote.waiting else _TAKE)
