# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A node that calls services of a running graph, for people who have no `ros2` command."""

import asyncio
import os
import time
from collections.abc import Coroutine
from typing import Any, TypeVar

from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest

from satvib_bringup.live.services.remote import LOOK, Remote
from satvib_bringup.live.topics.visitor import Visitor

_KIND = 'std_srvs/srv/Trigger'
_PATIENCE = 5.0  # s, for a service that is named
_SLICE = 0.05  # s
Result = TypeVar('Result')


class Caller(Visitor):
    """A context manager with a node in a context of its own."""

    def __init__(self) -> None:
        super().__init__('call')
        self._remote = Remote(self._node)

    def trigger(self, service: str, seconds: float) -> tuple[bool, str]:
        """Call a service of type std_srvs/Trigger; gives whether it was done, and what the node says.

        Args:
            service: its name; the first slash may be missing.
            seconds: within which the node must answer; the service is looked for as long, but 5 s at most.

        Raises:
            SatvibError: there is no such service, it is of another type, or no answer comes.
        """
        name = f'/{service.lstrip("/")}'
        self._find(name, min(seconds, _PATIENCE))
        node, _, what = name.rpartition('/')
        return asyncio.run(self._work_until(self._remote.trigger(node, what, seconds)))

    def _find(self, name: str, patience: float) -> None:
        """Wait until a service is there."""
        deadline = time.monotonic() + patience
        while name not in (kinds := dict(self._node.get_service_names_and_types())):
            if time.monotonic() > deadline:
                callable_ = sorted(n for n, found in kinds.items() if _KIND in found)
                raise SatvibError(f'{name}: no such service here; {_instead(name, callable_)}')
            self._spin(_SLICE)
        if _KIND not in kinds[name]:
            raise SatvibError(f'{name}: it is of type {kinds[name][0]}; only {_KIND} can be called')

    async def _work_until(self, asked: Coroutine[Any, Any, Result]) -> Result:
        """Let the node work until an answer is there."""
        answer = asyncio.ensure_future(asked)
        while not answer.done():
            self._spin(0.0)
            await asyncio.sleep(LOOK)
        return await answer


def _instead(name: str, known: list[str]) -> str:
    """What there is in the place of a service."""
    if not known:
        return f'no node of a graph is heard in domain {os.environ.get("ROS_DOMAIN_ID", "0")}'
    last = name.rpartition('/')[2]
    alike = [other for other in known if other.rpartition('/')[2] == last]
    return f'there are {", ".join(alike)}' if alike else nearest(name, known)
