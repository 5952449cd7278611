# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Front doors. Truth: the modules written here."""

import subprocess
import sys

import pytest
from satvib_common.door import public_names

DOOR = '''"""A room."""
from typing import TYPE_CHECKING
from satvib_common.door import door
if TYPE_CHECKING:
    from house.kitchen import Pot as Pan, stir
    from house.cellar import BOTTLES
__all__ = ['BOTTLES', 'Pan', 'stir']
__getattr__, __dir__ = door(__name__, __file__)
'''
KITCHEN = "from house import BOTTLES\nclass Pot: pass\ndef stir(): return BOTTLES\nprint('kitchen')"


@pytest.fixture
def house(tmp_path):
    room = tmp_path / 'house'
    room.mkdir()
    (room / '__init__.py').write_text(DOOR)
    (room / 'kitchen.py').write_text(KITCHEN)
    (room / 'cellar.py').write_text("BOTTLES = 3\nprint('cellar')")

    def run(code):
        path = ':'.join([str(tmp_path), *filter(None, sys.path)])
        done = subprocess.run(
            [sys.executable, '-c', code],
            env={'PYTHONPATH': path},
            capture_output=True,
            text=True,
            check=False,
        )
        return done.stdout.split(), done.stderr

    return run


def test_a_door_imports_nothing_until_a_name_is_asked_for(house):
    assert house('import house')[0] == []
    assert house('import house; print(house.BOTTLES)')[0] == ['cellar', '3']
    assert house('from house import Pan; print(Pan.__name__)')[0] == ['cellar', 'kitchen', 'Pot']


def test_modules_behind_a_door_may_use_the_door(house):
    """The kitchen imports from its own room's door: no circle."""
    assert house('from house.kitchen import stir; print(stir())')[0] == ['cellar', 'kitchen', '3']


def test_a_door_lists_its_names_and_refuses_others(house):
    assert house('import house; print(*dir(house))')[0] == ['BOTTLES', 'Pan', 'stir']
    out, error = house('from house import stove')
    assert out == []
    assert "cannot import name 'stove' from 'house'" in error


def test_public_names_come_from_the_block_for_the_type_checker_alone():
    assert public_names(DOOR) == {
        'Pan': ('house.kitchen', 'Pot'),
        'stir': ('house.kitchen', 'stir'),
        'BOTTLES': ('house.cellar', 'BOTTLES'),
    }
    assert public_names('from a import b') == {}
