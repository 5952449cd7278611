# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The list of faults, its page, and what the fault node does to messages. No graph is needed for them."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from elsewhere import OTHERS
from faults import CHAPTERS, QUICK
from mangling import Mangler, Mangling
from table import listed, named, others

PAGE = Path(__file__).parents[2] / 'docs' / 'faults.md'


def test_the_page_lists_the_faults_of_the_suite():
    """Truth: the list. The figures beside it are measured; benchmarks/faults.py writes both."""
    page = PAGE.read_text()
    assert named(page) == listed()
    assert others() in page


def test_every_test_that_the_list_names_is_there():
    """Truth: the files."""
    for fault in OTHERS:
        path, _, name = fault.test.partition('::')
        assert f'def {name}(' in (PAGE.parents[1] / path).read_text(), fault


def test_every_fault_has_a_name_of_its_own():
    names = [fault.name for faults in CHAPTERS.values() for fault in faults]
    assert len(set(names)) == len(names)
    assert set(QUICK) <= set(names)


def messages(count):
    return [
        SimpleNamespace(sequence=k, upper=float(k), header=SimpleNamespace(stamp=100 + k))
        for k in range(count)
    ]


def mangled(mangling, count=6):
    """Sequences that come out of a mangler, and how many it touched."""
    mangler = Mangler(mangling, seed=1)
    out = [m for message in messages(count) for m in mangler.take(message)]
    return [m.sequence for m in out + mangler.end()], mangler.touched


@pytest.mark.parametrize(
    ('do', 'expected', 'touched'),
    [
        ('lose', [], 6),
        ('double', [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5], 6),
        ('swap', [1, 0, 3, 2, 5, 4], 3),
        ('delay', [0, 1, 2, 3, 4, 5], 6),
        ('pass', [0, 1, 2, 3, 4, 5], 6),
    ],
)
def test_order_and_number_of_messages(do, expected, touched):
    """Truth: by hand."""
    assert mangled(Mangling(do, by=2)) == (expected, touched)


def test_a_delay_holds_messages_back():
    """Truth: by hand; two messages are always on their way."""
    mangler = Mangler(Mangling('delay', by=2), seed=1)
    assert [[m.sequence for m in mangler.take(message)] for message in messages(4)] == [
        [], [], [0], [1],
    ]  # fmt: skip


@pytest.mark.parametrize('damage', ['cut', 'flip'])
def test_damage(damage):
    """Truth: the bytes: a true beginning with its four bytes of encapsulation, or one bit that is another."""
    mangler = Mangler(Mangling(damage=damage), seed=1, serialize=lambda m: bytes(4) + m.text)
    text = b'a message'
    for _ in range(100):
        (found,) = mangler.take(SimpleNamespace(text=text))
        if damage == 'cut':
            assert 4 <= len(found) < 4 + len(text)
            assert (bytes(4) + text).startswith(found)
        else:
            bits = int.from_bytes(found) ^ int.from_bytes(bytes(4) + text)
            assert len(found) == 4 + len(text)
            assert found[:4] == bytes(4)
            assert bits.bit_count() == 1


def test_values_are_changed_in_a_copy():
    """Truth: by hand. A list is a turn of values; a slope grows with each message; a whole number goes round."""
    change = Mangling(
        put={'sequence': [7, 2**64]}, slope={'upper': 0.5}, add={'header.stamp': -1000}
    )
    mangler, given = Mangler(change, seed=1), messages(3)
    found = [mangler.take(m)[0] for m in given]
    assert [m.sequence for m in found] == [7, 0, 7]
    assert [m.upper for m in found] == [0.5, 2.0, 3.5]
    assert [m.header.stamp for m in found] == [2**64 - 900, 2**64 - 899, 2**64 - 898]
    assert [m.sequence for m in given] == [0, 1, 2]
    held = Mangler(Mangling(hold=('upper',)), seed=1)
    assert [held.take(m)[0].upper for m in given] == [0.0, 0.0, 0.0]


def test_a_share_is_a_share():
    """Truth: the binomial distribution; 5 standard deviations of 1000 draws at 0.3."""
    _, touched = mangled(Mangling('lose', 0.3), 1000)
    assert touched == pytest.approx(300, abs=5 * (1000 * 0.3 * 0.7) ** 0.5)
    assert mangled(Mangling('lose', 0.3), 1000)[1] == touched
