# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the buttons and fields of a page do."""

import asyncio
import contextlib
from collections.abc import Awaitable, Callable, Mapping
from typing import Any, Protocol

from satvib_common.errors import RunError, SatvibError

from satvib_bringup.live.services.remote import Remote
from satvib_bringup.watch.graph import WatchedGraph
from satvib_bringup.watch.live.record import Recording


class Asker(Protocol):
    """A page that has asked."""

    def tell(self, message: Mapping[str, Any]) -> None:
        """Send to this page."""


class Commands:
    """The commands of all pages.

    Args:
        graph: whose nodes are meant, and which says what came of it.
        remote: asks them.
        recording: records them.
    """

    def __init__(self, graph: WatchedGraph, remote: Remote, recording: Recording) -> None:
        self._graph, self._remote, self._recording = graph, remote, recording
        self._known: dict[str, Callable[[Mapping[str, Any], Asker], Awaitable[None]]] = {
            'stop': self._stop,
            'reset': self._reset,
            'arm': self._arm,
            'record': self._record,
            'parameters': self._parameters,
            'set': self._set,
        }

    async def __call__(self, request: Mapping[str, Any], page: Asker) -> None:
        """Do what a page asks for; whatever goes wrong is a line on all pages."""
        act = self._known.get(request['do'])
        try:
            if act is None:
                raise SatvibError(f'{request["do"]!r} is no command')
            # a page that ends with its process asks no more
            with contextlib.suppress(asyncio.CancelledError):
                await act(request, page)
        except (SatvibError, RunError, OSError) as error:
            self._graph.say(str(error), well=False)

    def controllers(self, strut: str | None = None) -> list[str]:
        """Nodes that write voltages, of one strut or of all."""
        return self._writers('voltage', strut)

    def plants(self) -> list[str]:
        """Nodes that write accelerations."""
        return self._writers('acceleration', None)

    def nodes(self) -> list[str]:
        """All nodes whose parameters a page may ask for."""
        return sorted(
            {n for s in self._graph.struts.values() for names in s.nodes.values() for n in names}
        )

    def _writers(self, what: str, strut: str | None) -> list[str]:
        struts = self._graph.struts
        if strut is not None and strut not in struts:
            raise SatvibError(f'{strut!r} is no strut that is heard')
        chosen = struts.values() if strut is None else [struts[strut]]
        return sorted({name for s in chosen for name in s.nodes.get(what, [])})

    async def _stop(self, request: Mapping[str, Any], _: Asker) -> None:
        strut = _text(request, 'strut')
        # the plant as well: it stops struts whose controllers do not answer
        nodes = self.controllers(strut) + (self.plants() if strut is None else [])
        await self._trigger_all(nodes, 'stop')

    async def _reset(self, request: Mapping[str, Any], _: Asker) -> None:
        strut = _text(request, 'strut')
        if strut is None:
            await self._trigger_all(self.plants(), 'reset')
        await self._trigger_all(self.controllers(strut), 'reset')

    async def _arm(self, _request: Mapping[str, Any], _: Asker) -> None:
        nodes = [node for node in self.plants() if self._remote.offers(node, 'arm')]
        if not nodes:
            raise SatvibError('arm: there is no hardware here')
        await self._trigger_all(nodes, 'arm')

    async def _trigger_all(self, nodes: list[str], what: str) -> None:
        if not nodes:
            raise SatvibError(f'{what}: no node is heard that could do it')
        await asyncio.gather(*(self._trigger(node, what) for node in nodes))

    async def _trigger(self, node: str, what: str) -> None:
        try:
            well, text = await self._remote.trigger(node, what)
        except SatvibError as error:
            self._graph.say(str(error), well=False)
            return
        self._graph.say(f'{node} {what}: {text}', well)

    async def _record(self, request: Mapping[str, Any], _: Asker) -> None:
        if request.get('on'):
            folder = self._recording.start(self._graph.struts)
            self._graph.recording = str(folder)
            self._graph.say(f'recording into {folder}')
            return
        try:
            folder = await self._recording.stop()
            self._graph.say(f'recorded: {folder}; report it with ./satvib report {folder}')
        finally:
            self._graph.recording = ''

    async def _parameters(self, request: Mapping[str, Any], page: Asker) -> None:
        node = self._node(request)
        found = await self._remote.parameters(node)
        page.tell({'kind': 'parameters', 'node': node, 'parameters': found})

    async def _set(self, request: Mapping[str, Any], page: Asker) -> None:
        node, name = self._node(request), _text(request, 'parameter')
        if name is None:
            raise SatvibError('set: no parameter is named')
        try:
            well, reason = await self._remote.set_parameter(node, name, request.get('value'))
            value = request.get('value')
            text = f'{node} {name} = {value}' if well else f'{node} {name}: {reason}'
            self._graph.say(text, well)
        finally:
            # what holds now, for who has asked; the others hear of it from the node
            await self._parameters(request, page)

    def _node(self, request: Mapping[str, Any]) -> str:
        node = _text(request, 'node')
        if node not in self.nodes():
            raise SatvibError(f'{node!r} is no node that is heard')
        assert node is not None
        return node


def _text(request: Mapping[str, Any], key: str) -> str | None:
    value = request.get(key)
    if value is not None and not isinstance(value, str):
        raise SatvibError(f'{key}: a text is expected, not {value!r}')
    return value
