# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Rigs load, and what is wrong with one is told by name."""

import dataclasses
import math

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema
from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.rig import Rig, load_rig, rig_names

NAMES = ['clean_1dof', 'clean_3dof', 'hexapod_6dof', 'paper_1dof', 'paper_3dof', 'soft_3dof']


def numbers(schema, path=''):
    """Dotted keys of all numeric fields of a rig."""
    for field in dataclasses.fields(schema):
        value = getattr(schema, field.name)
        key = f'{path}{field.name}'
        if isinstance(value, Schema):
            yield from numbers(value, f'{key}.')
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield key


KEYS = sorted(numbers(load_rig('paper_3dof')))


def test_the_rigs_of_the_design_are_there():
    """The list is the design's, with the 1-DOF twin of the clean rig, and the hexapod."""
    assert rig_names() == NAMES


@pytest.mark.parametrize('name', NAMES)
def test_rig_survives_the_way_to_plain_data_and_back(name):
    """Truth: the rig itself; exact."""
    rig = load_rig(name)
    assert rig.name == name
    assert Rig.from_mapping(yaml.safe_load(yaml.safe_dump(rig.to_mapping()))) == rig


def test_paper_numbers_are_the_papers():
    """Truth: the paper's set-up section (100 Hz, 200 Hz, 4 g, 100 Hz, 71.2 N, 7.6 mm, 20 V, 50 Hz)."""
    for name, rate in (('paper_3dof', 100.0), ('paper_1dof', 200.0)):
        rig = load_rig(name)
        assert rig.acquisition.sample_rate == rate
        assert rig.acquisition.filter_corner == 50.0
        assert rig.acquisition.hold == 'zero'
        assert rig.accelerometer.range == pytest.approx(4 * 9.80665)
        assert rig.accelerometer.bandwidth == 100.0
        assert rig.coil.force_limit == 71.2
        assert rig.coil.voltage_limit == 20.0
        assert rig.struts.stroke_limit == 7.6e-3


def test_every_number_of_a_rig_has_its_origin():
    """Truth: a comment stands above each number, or above the group of numbers that it opens."""
    from importlib import resources

    for name in NAMES:
        text = resources.files('satvib_plant_sim').joinpath('rigs', f'{name}.yaml').read_text()
        above = False
        for line in text.splitlines():
            key = line.strip().partition(':')[0]
            if line.strip().startswith('#'):
                above = True
            elif not line.startswith(' ') or key in {'count', 'hold', 'drive', 'sample_rate'}:
                above = '#' in line or above
            else:
                assert above, f'{name}: {line}'


def test_overrides_change_what_they_name_and_nothing_else():
    """Truth: the loaded rig."""
    base = load_rig('paper_3dof')
    rig = load_rig(
        'paper_3dof', {'payload.mass': 12, 'struts.stiffness_scale.1': 0.8, 'shaker.rigid': True}
    )
    assert rig.payload.mass == 12.0
    assert rig.struts.stiffness_scale == (0.97, 0.8, 1.03)
    assert rig.shaker.rigid
    assert rig.coil == base.coil
    assert rig.acquisition == base.acquisition


BAD = {
    'payload.mass=-1.0': 'payload.mass: -1.0 is not above 0.0 kg',
    'payload.mass=0': 'payload.mass: 0.0 is not above 0.0 kg',
    'payload.mass=heavy': "payload.mass: a number is expected, not str 'heavy'",
    'payload.maas=1.0': 'payload.maas: no such key',
    'payload.mass.x=1.0': 'payload.mass has no keys below it',
    'payloda.mass=1.0': 'payloda has no keys below it or does not exist',
    'payload=1.0': 'payload: is a group of keys',
    'acquisition.sample_rate=0.0': 'acquisition.sample_rate: 0.0 is not above 0.0 Hz',
    'acquisition.hold=cubic': "acquisition.hold: 'cubic' is not one of zero, linear",
    'acquisition.fine_rate=1000.0': 'acquisition.fine_rate: 1000.0 is less than 4000.0 Hz',
    'acquisition.input_delay=-0.1': 'acquisition.input_delay: -0.1 is less than 0.0 s',
    'struts.count=2': 'struts.count: 2 is not one of 1, 3',
    'struts.stiffness=-5.0': 'struts.stiffness: -5.0 is not above 0.0 N/m',
    'struts.stiffness_scale.7=1.0': 'not an index from 0 to 2',
    'coil.drive=steam': "coil.drive: 'steam' is not one of voltage, current",
    'accelerometer.zero_voltage=5.0': 'accelerometer.zero_voltage: 5.1 V at rest is outside',
}


@pytest.mark.parametrize('change', BAD)
def test_a_wrong_override_is_refused_by_name(change):
    """Truth: the message names the rig and the key."""
    key, _, value = change.partition('=')
    with pytest.raises(SatvibError) as refused:
        load_rig('paper_3dof', {key: yaml.safe_load(value)})
    assert str(refused.value).startswith('rig paper_3dof: ')
    assert BAD[change] in str(refused.value)
    assert '\n' not in str(refused.value)


@given(key=st.sampled_from(KEYS), value=st.floats(allow_nan=True, allow_infinity=True))
def test_any_number_anywhere_gives_a_rig_or_a_message_that_names_it(key, value):
    """Truth: no other exception, and no value that is not finite in a rig."""
    try:
        rig, complaint = load_rig('paper_3dof', {key: value}), ''
    except SatvibError as refused:
        rig, complaint = None, str(refused)
    if rig is None:
        assert key.split('.')[-1] in complaint or 'zero_voltage' in complaint
    else:
        node = rig
        for part in key.split('.'):
            node = getattr(node, part)
        assert math.isfinite(node)


def test_a_rigid_shaker_needs_no_mass_and_no_suspension(tmp_path):
    """Truth: the same rig with them, whose samples have the same bits; one that gives way names what is missing."""
    data = load_rig('soft_3dof', {'shaker.rigid': True}).to_mapping()
    given = load_rig('soft_3dof', {'shaker.rigid': True})
    path = tmp_path / 'mine.yaml'
    path.write_text(yaml.safe_dump(data | {'shaker': {'rigid': True}}))
    rig = load_rig(path)
    assert rig.shaker.mass is None
    tone = make_disturbance({'kind': 'sine', 'amplitude': 1.0, 'frequency': 9.0})
    for one, other in zip(*(_samples(Plant(r, tone, 1)) for r in (rig, given)), strict=True):
        np.testing.assert_array_equal(one, other)
    for shaker in ({}, {'mass': 5.0, 'damping': 1.0}):
        path.write_text(yaml.safe_dump(data | {'shaker': shaker}))
        missing = ', '.join(k for k in ('mass', 'stiffness', 'damping') if k not in shaker)
        with pytest.raises(SatvibError, match=rf'mine\.yaml: shaker\.{missing}: missing'):
            load_rig(path)
    path.write_text(yaml.safe_dump(data | {'shaker': {'rigid': True}}))
    with pytest.raises(SatvibError, match='only a rigid shaker needs none'):
        load_rig(path, {'shaker.rigid': False})


def _samples(plant):
    """Readings of 40 samples at 0 V."""
    found = []
    for _ in range(40):
        found.append(plant.sample().upper)
        plant.advance(np.zeros(3))
    return found


def test_files_of_ones_own(tmp_path):
    """A path is read; a broken file is told with its path."""
    path = tmp_path / 'mine.yaml'
    path.write_text(yaml.safe_dump({**load_rig('paper_1dof').to_mapping(), 'name': 'mine'}))
    assert load_rig(path, {'payload.mass': 4.0}).payload.mass == 4.0
    path.write_text(
        'payload: {mass: 3.0}\nstruts: {stiffness: 1e3, damping: 1.0, stop_damping: 1.0}\n'
    )
    at_once = r'struts\.stroke_limit, struts\.stop_stiffness, coil, shaker, accelerometer, acquisition: missing'
    with pytest.raises(SatvibError, match=rf'mine\.yaml: {at_once}'):
        load_rig(path)
    path.write_text('payload: {maas: 3.0}\n')
    with pytest.raises(SatvibError, match=r'payload\.maas: no such key; did you mean mass'):
        load_rig(path)
    path.write_text('- 1\n')
    with pytest.raises(SatvibError, match=r'mine\.yaml: a mapping of keys is expected'):
        load_rig(path)
    with pytest.raises(SatvibError, match=r'nothing\.yaml: cannot be read'):
        load_rig(tmp_path / 'nothing.yaml')
    with pytest.raises(SatvibError, match=r"rig 'paper_4dof': no such rig .known: clean_1dof"):
        load_rig('paper_4dof')
