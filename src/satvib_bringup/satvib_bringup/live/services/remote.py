# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is asked of the nodes of a graph: their services and their parameters, awaited by a coroutine.

A service is asked again when its answer does not come: ROS 2 loses a response when the server does not know the
client's reader yet. Everything that is asked here may be asked twice.
"""

import asyncio
import math
import time
from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from satvib_common.errors import SatvibError
from std_srvs.srv import Trigger

LOOK = 0.01  # s, between two looks whether an answer is there
_AGAIN, _PATIENCE = 5.0, 15.0  # s: after which it is asked again, and given up
_AT_ONCE = 5  # requests; a service keeps ten
_KINDS = {
    Parameter.Type.BOOL: bool,
    Parameter.Type.INTEGER: int,
    Parameter.Type.DOUBLE: float,
    Parameter.Type.STRING: str,
}
_LISTS = {
    Parameter.Type.BOOL_ARRAY: bool,
    Parameter.Type.INTEGER_ARRAY: int,
    Parameter.Type.DOUBLE_ARRAY: float,
    Parameter.Type.STRING_ARRAY: str,
}


class Remote:
    """Other nodes, seen from one node whose executor the caller runs.

    Args:
        node: that asks.

    Attributes:
        waiting: how many answers are awaited now.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self.waiting = 0
        self._triggers: dict[str, Any] = {}
        self._parameters: dict[str, AsyncParameterClient] = {}

    def prepare(self, node: str) -> None:
        """Make the client of the service that must be quick."""
        self._trigger(f'{node}/stop')

    def offers(self, node: str, what: str) -> bool:
        """Whether a node offers a service of a kind, as far as is known now."""
        return bool(self._trigger(f'{node}/{what}').service_is_ready())

    async def trigger(self, node: str, what: str, patience: float = _PATIENCE) -> tuple[bool, str]:
        """Call ~/`what` of a node; gives whether it was done, and what the node says.

        Args:
            node, what: names.
            patience: s, until it must have answered.

        Raises:
            SatvibError: no answer.
        """
        name = f'{node}/{what}'
        client = self._trigger(name)
        response = await self._ask(
            name, client, lambda: client.call_async(Trigger.Request()), patience
        )
        return bool(response.success), str(response.message)

    async def parameters(self, node: str) -> list[dict[str, Any]]:
        """Describe every parameter of a node, with its value.

        Raises:
            SatvibError: no answer.
        """
        client = self._client(node)
        listed = await self._ask(node, client, client.list_parameters)
        names = sorted(n for n in listed.result.names if not n.startswith('qos_overrides.'))
        described = await self._ask(node, client, lambda: client.describe_parameters(names))
        values = await self._values(node, names)
        return [
            _described(d, value)
            for d, value in zip(described.descriptors, values, strict=False)
        ]  # fmt: skip

    async def set_parameter(self, node: str, name: str, value: Any) -> tuple[bool, str]:
        """Set a parameter; gives whether it was done, and the node's reason if not.

        Raises:
            SatvibError: no such parameter, a value that is none for it, or no answer.
        """
        client = self._client(node)
        described = await self._ask(node, client, lambda: client.describe_parameters([name]))
        if not described.descriptors:
            raise SatvibError(f'{node}: there is no parameter {name}')
        kind = Parameter.Type(described.descriptors[0].type)
        parameter = Parameter(name, kind, typed(name, value, kind))
        answer = await self._ask(node, client, lambda: client.set_parameters([parameter]))
        result = answer.results[0]
        return bool(result.successful), str(result.reason)

    async def _values(self, node: str, names: list[str]) -> list[Any]:
        """Values of parameters; rclpy answers nothing at all when one of them is not set."""
        client = self._client(node)
        answer = await self._ask(node, client, lambda: client.get_parameters(names))
        if len(answer.values) != len(names):
            found: list[Any] = []
            for first in range(0, len(names), _AT_ONCE):
                some = names[first : first + _AT_ONCE]
                found += await asyncio.gather(*(self._value(client, name) for name in some))
            return found
        return [parameter_value_to_python(value) for value in answer.values]

    async def _value(self, client: AsyncParameterClient, name: str) -> Any:
        name_alone = [name]
        one = await self._ask(
            client.remote_node_name, client, lambda: client.get_parameters(name_alone)
        )
        return parameter_value_to_python(one.values[0]) if one.values else None

    def _trigger(self, service: str) -> Any:
        if service not in self._triggers:
            self._triggers[service] = self._node.create_client(Trigger, service)
        return self._triggers[service]

    def _client(self, node: str) -> AsyncParameterClient:
        if node not in self._parameters:
            self._parameters[node] = AsyncParameterClient(self._node, node)
        return self._parameters[node]

    async def _ask(
        self, name: str, client: Any, call: Callable[[], Any], patience: float = _PATIENCE
    ) -> Any:
        """Ask until an answer comes; that of an earlier call is as good."""
        is_ready = getattr(client, 'service_is_ready', None) or client.services_are_ready
        asked: list[Any] = []
        again = 0.0  # s of the steady clock
        self.waiting += 1
        try:
            async with asyncio.timeout(patience):
                while True:
                    if time.monotonic() >= again and is_ready():
                        asked.append(call())
                        again = time.monotonic() + _AGAIN
                    for future in asked:
                        if future.done():
                            return future.result()
                    await asyncio.sleep(LOOK)
        except TimeoutError:
            raise SatvibError(f'{name}: no answer within {patience:g} s') from None
        finally:
            self.waiting -= 1


def typed(name: str, value: Any, kind: Parameter.Type) -> Any:
    """Give a value from a page the type of a parameter.

    Raises:
        SatvibError: it cannot have that type.
    """
    try:
        if kind in _LISTS:
            return [_one(item, _LISTS[kind]) for item in value]
        return _one(value, _KINDS[kind])
    except (TypeError, ValueError, KeyError):
        raise SatvibError(f'parameter {name}: {value!r} is no value for it') from None


def _one(value: Any, kind: type) -> Any:
    if kind is float and isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    if kind is int and isinstance(value, float) and value.is_integer():
        return int(value)
    if type(value) is not kind:
        raise TypeError
    return value


def _described(descriptor: ParameterDescriptor, value: Any) -> dict[str, Any]:
    ranges = [*descriptor.floating_point_range, *descriptor.integer_range]
    low, high = (ranges[0].from_value, ranges[0].to_value) if ranges else (None, None)
    if descriptor.integer_range and ranges:
        low, high = (None if abs(end) >= 2**62 else end for end in (low or 0, high or 0))
    value = list(value) if hasattr(value, 'typecode') else value
    return {
        'name': descriptor.name,
        'type': Parameter.Type(descriptor.type).name.lower(),
        'text': descriptor.description,
        'rule': descriptor.additional_constraints,
        'fixed': bool(descriptor.read_only),
        'low': _finite(low),
        'high': _finite(high),
        'value': [_finite(v) for v in value] if isinstance(value, list) else _finite(value),
    }


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
