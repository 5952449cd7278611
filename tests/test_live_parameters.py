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


def test_a_gain_is_set_in_control_without_a_jump(start, probe):
    """Truth: the core of a controller, told the same samples and, at the same sample, the same gain; every bit.

    The law is linear in its gain, so at the sample of the change its voltage is 1.5 times that of a core that was not
    told; relative tolerance 1e-12 for the rounding of the product.
    """
    import math

    from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
    from rcl_interfaces.srv import SetParameters
    from satvib_common.phases import Phase, PhasePlan

    from satvib_control import ControllerCore, ControllerParameters
    from satvib_msgs.msg import StrutAcceleration, VcaVoltage

    law = {'law': 'velocity_feedback', 'velocity_gain': 30.0, 'control_at_start': True, 'struts': 1}
    process = start('satvib_control', 'strut_controller', '/strut_1', **law)
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    samples = probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    probe.wait(lambda: samples.get_subscription_count() == 1)
    told, untold = (ControllerCore(ControllerParameters(**law)) for _ in range(2))
    plan = PhasePlan((Phase.CONTROL,), (0,))
    for k in range(200):
        if k == 100:
            value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=45.0)
            request = SetParameters.Request(
                parameters=[Parameter(name='velocity_gain', value=value)]
            )
            service = '/strut_1/strut_controller/set_parameters'
            assert probe.call(SetParameters, service, request).results[0].successful
            told.apply(ControllerParameters(**law | {'velocity_gain': 45.0}))
        upper = 0.05 * math.sin(0.3 * k)
        samples.publish(StrutAcceleration(sequence=k, sample_period=0.01, upper=upper, lower=upper))
        found = probe.wait(
            lambda k=k: next((v for v in reversed(voltages) if v.sequence == k), None)
        )
        expected, other = (
            float(core.step(k, plan, upper, upper).voltage) for core in (told, untold)
        )
        assert found.voltage == expected
        assert not found.fault
        if k == 100:
            assert abs(other) > 1e-3
            assert found.voltage == pytest.approx(1.5 * other, rel=1e-12)
    assert process.popen.poll() is None
