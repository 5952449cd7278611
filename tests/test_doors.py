# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The doors of the rooms: one sentence, the public names, and nothing that runs. Truth of all tests: decision 9."""

import importlib
import importlib.util
import os

import pytest
from source_tree import modules, target

MODULES = modules()
DOORS = [m for m in MODULES.values() if m.is_door]
# rooms that import rclpy, which is there in the built and sourced workspace only
ROS_ROOMS = {'nodes', 'live', 'ros'}
HAS_ROS = importlib.util.find_spec('satvib_msgs') is not None and 'AMENT_PREFIX_PATH' in os.environ


def knows_ros(name: str) -> bool:
    """Whether a module may know ROS."""
    return bool(set(name.split('.')) & ROS_ROOMS)


@pytest.mark.parametrize('door', DOORS, ids=lambda m: m.name)
def test_a_door_is_one_sentence_and_the_public_names(door):
    """One sentence; `__all__` names what the block for the type checker imports; nothing runs."""
    assert door.summary.endswith('.'), f'{door.name}: no sentence'
    first = door.docstring.split('\n\n')[0]  # an example may follow
    assert door.summary == ' '.join(first.split()), f'{door.name}: one sentence, not more'
    assert len(door.summary.split()) > 2, f'{door.name}: {door.summary!r} says nothing'
    public = door.public
    shown = [i.alias or i.name for i in door.imports if i.when == 'types']
    assert isinstance(public, list), f'{door.name}: no __all__'
    assert sorted(shown) == sorted(public), f'{door.name}: __all__ and the imports differ'
    loaded = {i.module for i in door.imports if i.when != 'types'}
    assert loaded <= {'typing', 'satvib_common.door', '__future__'}, f'{door.name}: loads {loaded}'
    for item in door.imports:
        if item.when == 'types':
            at = target(item, MODULES)
            assert at is not None, f'{door.name}: {item.module} is no module of satvib'
            assert not MODULES[at].is_door, f'{door.name}: {item.name} comes from another door'
    if shown:
        assert '__getattr__, __dir__ = door(__name__, __file__)' in door.path.read_text()


@pytest.mark.parametrize('door', DOORS, ids=lambda m: m.name)
def test_every_public_name_can_be_imported(door):
    """By the way that a user takes: the door's attribute."""
    made = importlib.import_module(door.name)
    places = {i.alias or i.name: target(i, MODULES) for i in door.imports if i.when == 'types'}
    wanted = [n for n in made.__all__ if HAS_ROS or not knows_ros(places[n])]
    assert [name for name in wanted if not hasattr(made, name)] == []


@pytest.mark.parametrize('door', DOORS, ids=lambda m: m.name)
def test_no_public_name_is_that_of_a_module_beside_it(door):
    """Python puts a loaded module into its package under its own name, in front of what the door would give."""
    modules_beside = {n.rpartition('.')[2] for n in MODULES if n.rpartition('.')[0] == door.name}
    assert modules_beside & set(door.public) == set()
