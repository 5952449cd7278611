# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Channels: what is refused, and with which name. Truth: the rules stated in the schema."""

import copy
from pathlib import Path

import pytest
from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml
from satvib_daq_bridge.channels import load_channels, parse_channels

import satvib_daq_bridge

CONFIG = Path(satvib_daq_bridge.__file__).parent / 'config'
SERIAL = load_yaml(CONFIG / 'serial_3dof.yaml')


def changed(path, value):
    data = copy.deepcopy(SERIAL)
    node = data
    *parents, last = path.split('.')
    for key in parents:
        node = node[key]
    if value is KeyError:
        del node[last]
    else:
        node[last] = value
    return data


@pytest.mark.parametrize('file', sorted(CONFIG.glob('*.yaml')), ids=lambda p: p.stem)
def test_every_shipped_file_is_valid(file):
    channels = load_channels(file)
    channels.check_rate(100.0)
    assert len(channels.outputs) == 3
    assert len(channels.inputs) == 6


def test_the_papers_third_strut_is_on_a_second_board():
    outputs = dict(load_channels(CONFIG / 'comedi_3dof.yaml').outputs)
    assert outputs['strut_2.coil'].device == '/dev/comedi0'
    assert (outputs['strut_3.coil'].device, outputs['strut_3.coil'].index) == ('/dev/comedi1', 0)


@pytest.mark.parametrize(
    'key',
    [
        *(
            f'upper.{k}'
            for k in ('device', 'index', 'polarity', 'range', 'sensitivity', 'zero_voltage')
        ),
        *(f'coil.{k}' for k in ('device', 'index', 'polarity', 'range', 'gain', 'limit', 'slew')),
        *(f'coil.{k}' for k in ('continuous_force', 'force_constant', 'resistance')),
        'upper',
        'lower',
        'coil',
    ],
)
def test_what_is_missing_is_named_with_its_channel(key):
    with pytest.raises(SatvibError, match=rf'file.yaml: strut_2: {key}: missing'):
        parse_channels(changed(f'struts.strut_2.{key}', KeyError), 'file.yaml')


@pytest.mark.parametrize(
    ('path', 'value', 'message'),
    [
        ('struts.strut_1.coil.gain', 1.0, r'strut_1: coil.limit: 20 V .* is 20 V at the converter'),
        ('struts.strut_1.coil.range', [-5.0, 10.0], 'strut_1: coil.limit: .* beyond its 5 V'),
        ('struts.strut_1.coil.range', [0.0, 10.0], 'strut_1: coil.range: .* both signs'),
        ('struts.strut_3.coil.index', 1, 'strut_3.coil: output 1 of /dev/ttyACM0 .* strut_2.coil'),
        ('struts.strut_3.upper.index', 1, 'strut_3.upper: input 1 of .* belongs to strut_2.upper'),
        ('struts.strut_1.lower.index', 1, 'strut_1.lower: input 1 of .* belongs to strut_2.upper'),
        ('struts.strut_1.upper.polarity', 0, 'strut_1: upper.polarity: 0 is not one of 1, -1'),
        ('struts.strut_1.upper.range', [5.0, -5.0], 'strut_1: upper.range: the lowest and'),
        ('struts.strut_1.upper.range', [0.0, 2.6], 'strut_1: upper.zero_voltage: at rest'),
        ('struts.strut_1.upper.rest', 60.0, 'strut_1: upper.zero_voltage: at rest'),
        ('struts.strut_1.upper.sensitivity', 0.0, 'strut_1: upper.sensitivity: 0.0 is not above'),
        ('struts.strut_1.upper.device', '', 'strut_1: upper.device: is empty'),
        ('struts.strut_1.coil.sleew', 1.0, 'strut_1: coil.sleew: no such key; did you mean slew'),
        ('struts.strut_1', 5, 'file.yaml: strut_1: upper, lower and coil are expected'),
        ('struts.bad/name', {}, "'bad/name' cannot be the name of a namespace"),
        ('struts', {}, 'file.yaml: struts: none is given'),
        ('back_end', 'gpib', 'file.yaml: back_end: .gpib. is not one of loopback, replay'),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused_by_name(path, value, message):
    with pytest.raises(SatvibError, match=message):
        parse_channels(changed(path, value), 'file.yaml')


def test_a_slew_limit_below_one_step_of_the_converter_is_refused():
    """Truth: +-10 V, 12 bit, gain 2: a step is 9.77 mV at the coil; 0.9 V/s at 100 Hz is 9 mV."""
    channels = parse_channels(changed('struts.strut_2.coil.slew', 0.9), 'file.yaml')
    channels.check_rate(50.0)
    with pytest.raises(SatvibError, match=r'strut_2\.coil\.slew: 0\.9 V/s'):
        channels.check_rate(100.0)


def test_lower_sensors_may_be_one_and_the_same_or_none():
    shared = changed('struts.strut_1.lower.index', 4)
    assert len(parse_channels(shared, 'file.yaml').inputs) == 6
    without = changed('struts.strut_1.lower', None)
    assert [name for name, _ in parse_channels(without, 'file.yaml').inputs] == [
        'strut_1.upper', 'strut_2.upper', 'strut_3.upper', 'strut_2.lower', 'strut_3.lower',
    ]  # fmt: skip
