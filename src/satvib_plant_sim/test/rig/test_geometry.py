# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Rigs that list their struts: what they take, and what they refuse by name."""

import numpy as np
import pytest
import yaml
from numpy.testing import assert_allclose
from satvib_common.errors import SatvibError
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.physics.mechanics import mechanics
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.geometry import payload_matrix
from satvib_plant_sim.rig.rig import Rig, load_rig

NAME = 'hexapod_6dof'


def test_a_listed_strut_can_be_made_of_other_parts():
    """Truth: the numbers that were given, strut by strut; 1e-15."""
    own = {'stiffness': 1e4, 'damping': 7.0, 'force_constant': 5.0, 'stroke_limit': 1e-3}
    own |= {'force_limit': 30.0, 'resistance': 4.0, 'inductance': 1e-3}
    rig = load_rig(NAME, {f'struts.each.2.{key}': value for key, value in own.items()})
    m = mechanics(rig)
    assert_allclose(m.K[2], 1e4 * 1.05, rtol=1e-15)
    assert_allclose(m.K[3], 17410.0 * 0.98, rtol=1e-15)
    assert (m.C_strut[2], m.k[2], m.stroke_limit[2], m.force_limit[2], m.L[2]) == (
        7.0, 5.0, 1e-3, 30.0, 1e-3,
    )  # fmt: skip
    assert (m.C_strut[1], m.k[1], m.stroke_limit[1], m.force_limit[1], m.L[1]) == (
        39.6, 9.8, 7.6e-3, 71.2, 2.3e-3,
    )  # fmt: skip


def test_a_direction_is_as_good_as_a_head():
    """Truth: any point of the line of action has the same moment; 1e-15 m."""
    rig = load_rig(NAME)
    data = rig.to_mapping()
    for strut in data['struts']['each']:
        strut['direction'] = [
            3.0 * (h - f) for h, f in zip(strut['head'], strut['foot'], strict=True)
        ]
        strut['head'] = None
    other = Rig.from_mapping(data, 'other')
    assert_allclose(
        payload_matrix(other.payload, other.struts),
        payload_matrix(rig.payload, rig.struts),
        atol=1e-15,
    )


def test_listed_struts_survive_the_way_to_plain_data_and_back():
    """Truth: the rig itself; exact."""
    rig = load_rig(NAME, {'payload.center_of_gravity': [0.01, 0.0, 0.02]})
    assert Rig.from_mapping(yaml.safe_load(yaml.safe_dump(rig.to_mapping()))) == rig
    assert rig.struts.count == 6
    assert rig.coil.force_scale == (1.0,) * 6


BAD = {
    'struts.each.1.foot=[1, 2]': 'struts.each[1].foot: 2 numbers, x, y and z are expected',
    'struts.each.1.head=[0.176776695297, 0.102062072616, -0.072168783649]':
        'struts.each[1].head: gives no direction',
    'struts.each.1.foot=[176.8, 102.1, -72.2]': 'struts.each[1].foot: 176.8 is more than 50.0 m',
    'struts.each.5.head=[17.7, -10.2, 7.2]':
        'struts.each[5].head: 21.59 m from foot; a strut is 0.0001 to 10 m long',
    'struts.each.1.head=[0.176776695297, 0.102062072616, -0.07216]':
        'struts.each[1].head: 8.784e-06 m from foot; a strut is 0.0001 to 10 m long',
    'struts.each.2.stroke_limit=7.6': 'struts.each[2].stroke_limit: 7.6 is more than 1.0 m',
    'payload.center_of_gravity=[0, -80, 0]': 'payload.center_of_gravity: -80.0 is less than -50.0 m',
    'struts.radius=150': 'struts.radius: 150.0 is more than 10.0 m',
    'struts.each.1.direction=[1, 0, 0]': 'struts.each[1].head: a strut has either head or direction',
    'struts.each.1.stiffness=-2': 'stiffness: -2.0 is not above 0.0 N/m',
    'struts.count=5': 'struts.count: 5, but 6 struts are listed',
    'struts.stiffness_scale=[1, 2]': 'struts.stiffness_scale: 2 factors for 6 struts',
    'coil.force_scale=[1, 2]': 'coil.force_scale: 2 factors for 6 struts',
    'payload.inertia_tensor=[1, 1]': 'payload.inertia_tensor: 2 numbers, not 3 or 6',
    'payload.inertia_tensor=[1, 1, 1, 2, 0, 0]': 'payload.inertia_tensor: not positive definite',
    'payload.inertia_tensor=null': 'payload.inertia_tensor: missing; the payload can turn',
    'payload.inertia=0.3': 'payload.inertia: a rig that lists its struts has inertia_tensor',
    'payload.center_of_gravity=[1]': 'payload.center_of_gravity: 1 numbers',
    'payload.motions=[x, x]': 'payload.motions: each is named once',
    'payload.motions=[up]': "payload.motions: 'up' is not one of x, y, z, rx, ry, rz",
    'payload.force_z=1': 'payload.force_z: no such key',
}  # fmt: skip


@pytest.mark.parametrize('change', BAD)
def test_a_wrong_description_is_refused_by_name(change):
    """Truth: the message names the rig and the key, in one line."""
    key, _, value = change.partition('=')
    with pytest.raises(SatvibError) as refused:
        load_rig(NAME, {key: yaml.safe_load(value)})
    assert str(refused.value).startswith(f'rig {NAME}: ')
    assert BAD[change] in str(refused.value)
    assert '\n' not in str(refused.value)


def test_struts_that_do_not_hold_the_payload_are_refused():
    """Truth: six parallel struts hold three motions (Gauss: columns of x, y and rz are 0)."""
    data = load_rig(NAME).to_mapping()
    for strut in data['struts']['each']:
        strut['head'], strut['direction'] = None, [0.0, 0.0, 1.0]
    with pytest.raises(
        SatvibError, match='6 struts hold 3 of the motions x, y, z, rx, ry, rz; add'
    ):
        Rig.from_mapping(data, 'parallel')
    data['payload']['motions'] = ['z', 'rx', 'ry']
    assert Rig.from_mapping(data, 'guided').struts.count == 6


@pytest.mark.parametrize(
    'key', ['inertia_tensor=[1, 1, 1]', 'center_of_gravity=[0, 0, 0.1]', 'motions=[z]']
)
def test_a_circle_refuses_the_keys_of_listed_struts(key):
    """Truth: the message names the key and the way out."""
    name, _, value = key.partition('=')
    with pytest.raises(SatvibError, match=rf'payload\.{name}: only a rig that lists its struts'):
        load_rig('soft_3dof', {f'payload.{name}': yaml.safe_load(value)})


def test_a_direction_that_the_rig_does_not_have_is_refused():
    """Truth: under struts on a circle the base moves along z alone."""
    shake = {'kind': 'sine', 'frequency': 5.0, 'amplitude': 1.0}
    sideways = make_disturbance({**shake, 'direction': [1.0, 0.0, 0.0]})
    with pytest.raises(SatvibError, match='direction: 1, 0, 0: the struts of this rig stand on a'):
        Plant(load_rig('soft_3dof'), sideways, 1)
    # down is up the other way round
    plants = [
        Plant(load_rig('soft_3dof'), make_disturbance({**shake, 'direction': [0.0, 0.0, z]}), 1)
        for z in (1.0, -1.0)
    ]
    for _ in range(20):
        up, down = (plant.advance([0.0, 0.0, 0.0]).lower for plant in plants)
        assert_allclose(up, -down, rtol=0.0, atol=1e-15)
    assert np.abs(up).max() > 0.1
    with pytest.raises(
        SatvibError, match='direction: 3 or 6 numbers are expected, not all of them 0'
    ):
        make_disturbance({**shake, 'direction': [0.0, 0.0, 0.0]})
