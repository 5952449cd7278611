# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""ROS parameters from a schema: declared, read, checked as a whole, applied.

The dataclass is the only description. Each field becomes a parameter with its type, unit, range, description and
read-only flag. A change is tried on a copy of the whole set. If it is refused, its one-line reason is the answer and
nothing changes.
"""

import difflib
import math
import typing
from collections.abc import Callable, Iterable
from dataclasses import MISSING, Field, fields
from typing import Any, Generic, TypeVar

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter

from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, constraint_of

S = TypeVar('S', bound=Schema)

_SCALARS = {
    bool: Parameter.Type.BOOL,
    int: Parameter.Type.INTEGER,
    float: Parameter.Type.DOUBLE,
    str: Parameter.Type.STRING,
}
_ARRAYS = {
    bool: Parameter.Type.BOOL_ARRAY,
    int: Parameter.Type.INTEGER_ARRAY,
    float: Parameter.Type.DOUBLE_ARRAY,
    str: Parameter.Type.STRING_ARRAY,
}
_WORDS = {
    Parameter.Type.BOOL: 'true or false',
    Parameter.Type.INTEGER: 'a whole number',
    Parameter.Type.DOUBLE: 'a number with a decimal point',
    Parameter.Type.STRING: 'text',
    Parameter.Type.BOOL_ARRAY: 'a list of true or false',
    Parameter.Type.INTEGER_ARRAY: 'a list of whole numbers',
    Parameter.Type.DOUBLE_ARRAY: 'a list of numbers with a decimal point',
    Parameter.Type.STRING_ARRAY: 'a list of texts',
}
# Parameters that rclpy itself understands.
_ROS = ('use_sim_time', 'start_type_description_service', 'autostart')


class NodeParameters(Generic[S]):
    """The parameters of a node, always one valid value of a schema.

    Args:
        node: the node that declares them.
        schema: a schema of bool, int, float, str and tuples of them.
        changed: called with the new set and the names that were set, after a change; gives what people should know
            about its effect, empty for nothing.

    Raises:
        SatvibError: an override of the wrong type or out of range, or a set that contradicts itself.
    """

    def __init__(
        self, node: Node, schema: type[S], changed: Callable[[S, frozenset[str]], str]
    ) -> None:
        self._changed, self._log, self._effect = changed, node.get_logger(), ''
        self._names = {field.name for field in fields(schema)}
        self._read_only = {
            field.name: why for field in fields(schema) if (why := constraint_of(field).read_only)
        }
        self._warn_unknown(node)
        hints = typing.get_type_hints(schema)
        given = {f.name: _declared(node, f, hints[f.name]) for f in fields(schema)}
        self.value = schema.from_mapping({k: v for k, v in given.items() if v is not None})
        node.add_on_set_parameters_callback(self._validate)
        node.add_post_set_parameters_callback(self._apply)

    def unknown(self, name: str) -> str:
        """Say that there is no such parameter, and which one may be meant."""
        close = difflib.get_close_matches(name, list(self._names), n=1)
        return f'{name}: no such parameter' + (f'; did you mean {close[0]}?' if close else '')

    def unknown_of(self, node: Node, parameters: Iterable[Parameter]) -> SetParametersResult | None:
        """Refuse a change that names no parameter, of which rclpy gives no name; None: all are there."""
        for parameter in parameters:
            if not node.has_parameter(parameter.name):
                return SetParametersResult(successful=False, reason=self.unknown(parameter.name))
        return None

    def explain(
        self, result: SetParametersResult, parameters: Iterable[Parameter]
    ) -> SetParametersResult:
        """Say what rclpy does not: why a read-only parameter is refused, and what a change that is taken does."""
        effect, self._effect = self._effect, ''
        if result.successful:
            result.reason = result.reason or effect
        for parameter in parameters:
            name, why = parameter.name, self._read_only.get(parameter.name)
            if why and not result.successful and name in result.reason:
                result.reason = f'{name} is read-only: {why}'
        return result

    def _with(self, parameters: list[Parameter]) -> S:
        return self.value.changed({p.name: p.value for p in parameters if p.name in self._names})

    def _validate(self, parameters: list[Parameter]) -> SetParametersResult:
        try:
            self._with(parameters)
        except SatvibError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _apply(self, parameters: list[Parameter]) -> None:
        names = [p.name for p in parameters if p.name in self._names]
        if names:
            before, self.value = self.value, self._with(parameters)
            self._effect = self._changed(self.value, frozenset(names))
            said = [f'{n}: {getattr(before, n)} -> {getattr(self.value, n)}' for n in names]
            self._log.info('; '.join(filter(None, (*said, self._effect))))

    def _warn_unknown(self, node: Node) -> None:
        """Warn of an override that names no parameter, which ROS ignores without a message."""
        given = getattr(node, '_parameter_overrides', {})
        for name in given:
            if name in self._names or name in _ROS or name.startswith('qos_overrides.'):
                continue
            node.get_logger().warning(f'parameter {self.unknown(name)}, ignored')


def _parameter_type(hint: Any) -> Parameter.Type:
    if typing.get_origin(hint) is tuple:
        return _ARRAYS[typing.get_args(hint)[0]]
    return _SCALARS[hint]


def _declared(node: Node, field: Field[Any], hint: Any) -> Any:
    """Declare one field and give its value; None when it was not set and has no default."""
    kind = _parameter_type(hint)
    overrides: dict[str, Parameter] = getattr(node, '_parameter_overrides', {})
    default: Any = kind
    if isinstance(field.default, tuple):
        # rclpy takes the type from the value, and an empty list has none; without a value rclpy would answer nothing
        # at all to those who ask for several parameters
        default = list(field.default) or kind
        given = overrides[field.name].value if field.name in overrides else field.default
        if given in ([], (), None):  # None: an empty list of a parameter file
            overrides.pop(field.name, None)
            node.declare_parameter(field.name, kind, describe(field, kind))
            # rclpy offers no way to give an empty list its type
            vars(node)['_parameters'][field.name] = Parameter(field.name, kind, [])
            return []
    elif field.default is not MISSING:
        default = field.default
    try:
        value = node.declare_parameter(field.name, default, describe(field, kind)).value
    except InvalidParameterTypeException:
        given = overrides[field.name].value
        raise SatvibError(
            f'parameter {field.name}: {_WORDS[kind]} is expected, not {given!r}'
        ) from None
    except InvalidParameterValueException as error:
        given = overrides[field.name].value
        complaint = constraint_of(field).complaint(given)
        raise SatvibError(f'parameter {field.name}: {complaint or error}') from None
    return list(value) if kind in _ARRAYS.values() and value is not None else value


def describe(field: Field[Any], kind: Parameter.Type) -> ParameterDescriptor:
    """What tools show of a field: its description with the unit, its limits, whether it can change."""
    constraint = constraint_of(field)
    unit = f' [{constraint.unit}]' if constraint.unit else ''
    descriptor = ParameterDescriptor(
        name=field.name,
        description=f'{constraint.description}{unit}',
        read_only=bool(constraint.read_only),
        additional_constraints=_in_words(field),
    )
    low = constraint.minimum if constraint.minimum is not None else constraint.above
    high = constraint.maximum if constraint.maximum is not None else constraint.below
    if low is None and high is None:
        return descriptor
    if kind is Parameter.Type.DOUBLE:
        descriptor.floating_point_range = [
            FloatingPointRange(
                from_value=-math.inf if low is None else float(low),
                to_value=math.inf if high is None else float(high),
            )
        ]
    elif kind is Parameter.Type.INTEGER:
        descriptor.integer_range = [
            IntegerRange(
                from_value=-(2**63) if low is None else int(low),
                to_value=2**63 - 1 if high is None else int(high),
                step=1,
            )
        ]
    return descriptor


def _in_words(field: Field[Any]) -> str:
    constraint = constraint_of(field)
    words = []
    if constraint.choices is not None:
        words.append(f'one of {", ".join(map(str, constraint.choices))}')
    if constraint.above is not None:
        words.append(f'above {constraint.above:g}')
    if constraint.below is not None:
        words.append(f'below {constraint.below:g}')
    if constraint.read_only:
        words.append(f'read-only: {constraint.read_only}')
    return '; '.join(words)
