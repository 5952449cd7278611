# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a bench and their tables."""

import numpy as np
import pytest
from satvib_bringup.live.bench.case import Case, Figures, medians, quick_cases, whole_cases
from satvib_bringup.live.bench.run import summary
from satvib_bringup.live.bench.table import markdown


def test_latency_late_and_missed_by_hand():
    """Truth: by hand. Two struts, samples 10 to 29 count, 100 Hz: one voltage late, one missing, one twice."""
    rows = [[s, k, 0.002] for k in range(30) for s in (0, 1)]
    rows[2 * 15][2] = 0.012
    rows.append([0, 20, 0.009])  # a controller that was started again
    rows.remove([1, 25, 0.002])
    figures = Figures()
    figures.take_arrivals(np.array(rows), 2, 100.0, 10, 30)
    assert figures.p50 == pytest.approx(2.0)
    assert figures.most == pytest.approx(12.0)
    assert figures.late == pytest.approx(1 / 39)
    assert figures.missed == pytest.approx(1 / 40)
    nothing = Figures()
    nothing.take_arrivals(np.zeros((0, 3)), 2, 100.0, 10, 30)
    assert nothing.failed == 'no voltage'


def test_ratios_are_to_the_first_floor():
    """Truth: by hand: medians of three, a failed run left out."""
    case = Case(3, 200.0, False, ('separate',), ('single',), 1.0)
    runs = {
        'bare separate': [Figures(samples_per_s=v, cpu=2.0) for v in (390.0, 400.0, 500.0)],
        'satvib single': [
            Figures(samples_per_s=800.0, cpu=1.0),
            Figures(samples_per_s=840.0, cpu=1.0),
            Figures(failed='no voltage'),
        ],
    }
    found = summary(case, runs)
    single = found['graphs']['satvib single']
    assert single['median'] == {'samples_per_s': 820.0, 'cpu': 1.0}
    assert single['ratio'] == {'samples_per_s': pytest.approx(2.05), 'cpu': 0.5}
    assert single['span']['samples_per_s'] == (800.0, 840.0)
    text = markdown({'machine': {'processors': 2, 'python': '3'}, 'rounds': 3, 'cases': [found]})
    assert '| satvib single | 820 (x 2.05) | 1.00 (x 0.50) |' in text
    assert '| bare separate | 400 | 2.00 |' in text
    assert 'satvib single failed: no voltage' in text


def test_medians_of_nothing():
    """Truth: a graph that always failed has no figures."""
    assert medians([Figures(failed='x')]) == ({}, {})


def test_the_whole_form_has_every_rate_and_number_of_struts():
    """Truth: what the page promises."""
    cases = whole_cases()
    assert {c.struts for c in cases} == {1, 3, 6}
    assert {c.rate for c in cases if c.realtime and c.struts == 3} == {100.0, 200.0, 500.0, 1000.0}
    assert all(c.compositions == ('separate', 'strut', 'single') for c in cases)
    assert {c.realtime for c in quick_cases()} == {False, True}
