# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The ROS parameters of the controllers keep their names, types, defaults and ranges, wherever their schemas stand."""

import dataclasses
import typing
from pathlib import Path

import pytest
from satvib_common.files.yaml_file import load_yaml
from satvib_common.schema import constraint_of
from satvib_control.laws.centralized.parameters import CentralizedParameters
from satvib_control.parameters import ControllerParameters
from satvib_control.supervision.parameters import SupervisorParameters

KNOWN = load_yaml(Path(__file__).with_name('ros_parameters.yaml'))


def description(field, hint):
    """What `ros2 param describe` says of a parameter, without its text."""
    constraint = dataclasses.asdict(constraint_of(field))
    text, why = constraint.pop('description'), constraint['read_only']
    assert text, f'{field.name} has no description'
    assert isinstance(why, str), f'{field.name}: read_only says why, in words'
    constraint['read_only'] = bool(why)
    found = {'type': str(hint) if typing.get_origin(hint) else hint.__name__}
    found['default'] = list(field.default) if isinstance(field.default, tuple) else field.default
    for name, value in constraint.items():
        if value is not None and value != '' and name != 'finite':
            found[name] = list(value) if isinstance(value, tuple) else value
    return found


@pytest.mark.parametrize(
    ('node', 'schema'),
    [
        ('strut_controller', ControllerParameters),
        ('centralized_controller', CentralizedParameters),
        ('supervisor', SupervisorParameters),
    ],
)
def test_the_ros_parameters_of_a_node_are_the_known_ones(node, schema):
    """Truth: ros_parameters.yaml, which people's parameter files and scenarios rely on."""
    hints = typing.get_type_hints(schema)
    found = {f.name: description(f, hints[f.name]) for f in dataclasses.fields(schema)}
    shared = {} if node == 'supervisor' else KNOWN['strut_controller']
    assert found == shared | KNOWN[node]
