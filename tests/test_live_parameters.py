# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What `ros2 param` asks of a node, over its services: dump, load and describe give every parameter of every node."""

import math

import numpy as np
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


RATE = 100.0
# a strut with a mode at 8 Hz, V to m/s^2
MODEL = {'a': [-1.6, 0.85], 'b': [0.05, -0.05], 'delay': 1}
LAWS = {
    'velocity_feedback': ({'velocity_gain': 30.0}, {'velocity_gain': 45.0}, 1.5),
    'model_reference': ({'adapted_gains': [], 'gain_i': 20.0}, {'gain_i': 30.0}, 1.5),
    'narrowband': ({}, {'narrowband_settling': 0.3}, None),
    'feedforward': (
        {'feedforward_method': 'fxlms', 'feedforward_struts': 1},
        {'feedforward_step': 0.4},
        None,
    ),
}


class Strut:
    """y = d + G u: the strut that answers the voltages, shaken by a tone."""

    def __init__(self):
        self.moved, self.volts = [0.0, 0.0], [0.0, 0.0]

    def sample(self, k):
        """Upper and lower acceleration, m/s^2."""
        a, b = MODEL['a'], MODEL['b']
        x, u = self.moved[::-1], self.volts[::-1]
        self.moved = [x[0], b[0] * u[0] + b[1] * u[1] - a[0] * x[0] - a[1] * x[1]]
        return 0.5 * math.sin(0.6 * k) + self.moved[-1], 0.8 * math.sin(0.6 * k + 0.4)

    def answer(self, voltage):
        self.volts = [self.volts[-1], voltage]


def set_double(probe, node, name, value):
    """Set one parameter, as `ros2 param set` does."""
    from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
    from rcl_interfaces.srv import SetParameters

    number = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)
    request = SetParameters.Request(parameters=[Parameter(name=name, value=number)])
    result = probe.call(SetParameters, f'{node}/set_parameters', request).results[0]
    assert result.successful, result.reason


def give_model(probe):
    """Publish a trusted model of sample 0. The node has it when this returns, for it works on what comes in order."""
    from rclpy.duration import Duration

    from satvib_msgs.msg import IirParameters

    publisher = probe.publisher(IirParameters, '/strut_1/identified_model')
    probe.wait(lambda: publisher.get_subscription_count() == 1)
    count = len(MODEL['a']) + len(MODEL['b'])
    message = IirParameters(
        sample_period=1.0 / RATE, converged=True, covariance=[0.0] * count**2, bias=math.nan,
        bias_lower=math.nan, **MODEL,
    )  # fmt: skip
    publisher.publish(message)
    assert publisher.wait_for_all_acked(Duration(seconds=30))
    assert probe.state_of('/strut_1/strut_controller') == 'active'


@pytest.mark.parametrize('name', LAWS)
def test_a_setting_of_each_law_is_taken_in_control_without_a_jump(start, probe, name):
    """Truth: a core in this process, told the same samples, model and setting at the same sample; every bit.

    Another core is not told. At the sample of the change the voltage differs from its by the ratio of the gains
    (relative tolerance 1e-12 for rounding); by less than 1 % of the largest voltage where the setting is no gain.
    """
    from satvib_common.phases import Phase, PhasePlan
    from satvib_ident.models.iir_model import IirModel

    from satvib_control import ControllerCore, ControllerParameters
    from satvib_msgs.msg import StrutAcceleration, VcaVoltage

    old, new, ratio = LAWS[name]
    given = {'law': name, 'control_at_start': True, 'struts': 1, **old}
    p = ControllerParameters.from_mapping(given)
    process = start('satvib_control', 'strut_controller', '/strut_1', **given)
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    samples = probe.publisher(StrutAcceleration, '/strut_1/acceleration')
    probe.wait(lambda: samples.get_subscription_count() == 1)
    give_model(probe)
    told, untold = (ControllerCore(p) for _ in range(2))
    count = len(MODEL['a']) + len(MODEL['b'])
    model = IirModel(np.array(MODEL['a']), np.array(MODEL['b']), MODEL['delay'], 1.0 / RATE)
    for core in (told, untold):
        core.set_model(model, covariance=np.zeros((count, count)))
    plan = PhasePlan((Phase.CONTROL,), (0,))
    strut, largest, change, differs = Strut(), 0.0, 500, False
    for k in range(1, 700):
        if k == change:
            for parameter, value in new.items():
                set_double(probe, '/strut_1/strut_controller', parameter, value)
            told.apply(p.replace(**new))
        upper, lower = strut.sample(k)
        message = StrutAcceleration(sequence=k, sample_period=0.01, upper=upper, lower=lower)
        samples.publish(message)
        found = probe.wait(
            lambda k=k: voltages[-1] if voltages and voltages[-1].sequence == k else None
        )
        expected, other = (
            float(core.step(k, plan, upper, lower).voltage) for core in (told, untold)
        )
        assert found.voltage == expected
        assert not found.fault
        strut.answer(found.voltage)
        if k == change and ratio:
            assert abs(other) > 1e-3
            assert found.voltage == pytest.approx(ratio * other, rel=1e-12)
        elif k == change:
            assert abs(found.voltage - other) < 0.01 * largest
        largest = max(largest, abs(expected))
        differs = differs or expected != other
    assert differs  # it was taken
    assert largest > 0.01
    line = 'sample 1: model of sample 0 taken: 2 poles, 2 coefficients, delay 1, trusted'
    assert process.said.count(line) == 1
    assert process.popen.poll() is None
