# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What `ros2 param` asks of a node, over its services: dump, load and describe give every parameter of every node."""

import pytest
import yaml

NODES = {
    'plant_sim': ('satvib_plant_sim', {}),
    'strut_controller': ('satvib_control', {}),
    'centralized_controller': ('satvib_control', {}),
    'supervisor': ('satvib_control', {}),
    'strut_identifier': ('satvib_ident', {}),
    'recorder': ('satvib_bringup', {}),
    'schedule': ('satvib_bringup', {}),
    'replay': ('satvib_bringup', {'file': 'record.csv'}),
    'experiment': ('satvib_bringup', {}),
    'daq_bridge': ('satvib_daq_bridge', {'channels': 'channels.yaml'}),
}


def dump(probe, node):
    """Every parameter and its value, asked for in one request as `ros2 param dump` does."""
    from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters
    from rclpy.parameter import parameter_value_to_python

    names = probe.call(ListParameters, f'{node}/list_parameters', ListParameters.Request())
    names = sorted(n for n in names.result.names if not n.startswith('qos_overrides.'))
    request = GetParameters.Request(names=names)
    values = probe.call(GetParameters, f'{node}/get_parameters', request).values
    assert len(values) == len(names)
    request = DescribeParameters.Request(names=names)
    descriptors = probe.call(DescribeParameters, f'{node}/describe_parameters', request).descriptors
    assert [d.name for d in descriptors] == names
    assert [d.type for d in descriptors] == [v.type for v in values]
    assert 0 not in [v.type for v in values]  # 0: not set
    found = [parameter_value_to_python(v) for v in values]
    return dict(zip(names, (list(v) if hasattr(v, 'tolist') else v for v in found), strict=True))


@pytest.mark.parametrize('name', NODES)
def test_a_dump_is_whole_and_can_be_loaded(start, probe, name):
    """Truth: the node itself. A second one, started with the dump of the first, has the same parameters."""
    package, needed = NODES[name]
    start(package, name, '/one', autostart=False, **needed)
    first = dump(probe, f'/one/{name}')
    assert len(first) > 2
    parameters = yaml.safe_load(yaml.safe_dump(first))
    start(package, name, '/two', **parameters)
    assert dump(probe, f'/two/{name}') == first
