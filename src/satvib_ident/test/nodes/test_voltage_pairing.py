# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Pairing of samples and voltages, whatever order they come in."""

import math

from hypothesis import given
from hypothesis import strategies as st
from satvib_common.sequence import Arrival, SequenceTracker
from satvib_ident.nodes.voltage_pairing import VoltagePairing


def drain(pairing):
    return [(sample, voltage) for sample, voltage, _ in pairing.pairs()]


def test_each_sample_keeps_how_it_arrived():
    """Truth: by hand; the tracker is asked once for each sample, and a repeated one is left out."""
    samples = SequenceTracker()
    pairing = VoltagePairing(0, wait=True, samples=samples)
    for k in (0, 1, 4):
        pairing.add_voltage(k, 1.0)
    found = []
    for k in (0, 1, 1, 4):
        pairing.add_sample(k, k)
        found += [(k, arrival) for k, _, arrival in pairing.pairs()]
    assert found == [(0, Arrival.FIRST), (1, Arrival.NEXT), (4, Arrival.GAP)]
    assert (samples.lost, samples.repeats) == (2, 1)


@given(st.integers(0, 3), st.randoms(use_true_random=False), st.integers(1, 40))
def test_any_interleaving_gives_the_same_pairs(delay, random, count):
    """Truth: y(k) belongs to u(k - delay), 0 V before sample 0. Each stream is in order, their mix is arbitrary."""
    pairing = VoltagePairing(delay, wait=True)
    samples, voltages, found = list(range(count)), list(range(count)), []
    while samples or voltages:
        if samples and (not voltages or random.random() < 0.5):
            k = samples.pop(0)
            pairing.add_sample(k, k)
        else:
            k = voltages.pop(0)
            pairing.add_voltage(k, 100.0 + k)
        found += drain(pairing)
    assert found == [(k, 100.0 + k - delay if k >= delay else 0.0) for k in range(count)]
    assert pairing.unknown == 0


def test_in_real_time_a_voltage_has_until_the_next_sample():
    """Truth: the node's rule, by hand."""
    pairing = VoltagePairing(1, wait=False)
    pairing.add_sample(0, 'a')
    pairing.add_sample(1, 'b')
    assert drain(pairing) == [('a', 0.0)]
    pairing.add_sample(2, 'c')
    (first,) = drain(pairing)
    assert first[0] == 'b'
    assert math.isnan(first[1])
    pairing.add_voltage(1, 7.0)
    assert drain(pairing) == [('c', 7.0)]
    assert pairing.unknown == 1


def test_a_voltage_that_was_passed_over_is_not_waited_for():
    """Truth: topics are in order, so voltage 3 proves that voltage 2 is lost."""
    pairing = VoltagePairing(0, wait=True)
    pairing.add_sample(2, 'x')
    assert drain(pairing) == []
    pairing.add_voltage(3, 1.0)
    ((_, voltage),) = drain(pairing)
    assert math.isnan(voltage)


def test_voltages_ahead_of_the_first_sample_are_kept():
    """Truth: discovery may deliver one topic before the other; nothing of the run is lost."""
    pairing = VoltagePairing(1, wait=True)
    for k in range(5):
        pairing.add_voltage(k, float(k))
    for k in range(6):
        pairing.add_sample(k, k)
    assert drain(pairing) == [(0, 0.0), (1, 0.0), (2, 1.0), (3, 2.0), (4, 3.0), (5, 4.0)]


def test_a_new_run_forgets_the_old_whichever_stream_restarts_first():
    """Truth: by hand; the second run's voltages are 50 + k."""
    for voltage_first in (False, True):
        pairing = VoltagePairing(1, wait=True)
        for k in range(300):
            pairing.add_sample(k, k)
            pairing.add_voltage(k, 10.0)
        drain(pairing)
        steps = [lambda p=pairing: p.add_sample(0, 0), lambda p=pairing: p.add_voltage(0, 50.0)]
        for step in reversed(steps) if voltage_first else steps:
            step()
        pairing.add_sample(1, 1)
        assert drain(pairing) == [(0, 0.0), (1, 50.0)]
        pairing.add_sample(2, 2)
        assert drain(pairing) == []
        assert pairing.unknown == 0


def test_memory_is_bounded():
    """Truth: what has been paired is of no use; 10 000 pairs leave next to nothing."""
    pairing = VoltagePairing(1, wait=True)
    for k in range(10_000):
        pairing.add_sample(k, k)
        pairing.add_voltage(k, 1.0)
        drain(pairing)
    assert len(pairing._known) < 10
