# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The bench in its shortest form: real processes, and figures that can be checked against each other."""

import pytest


@pytest.mark.usefixtures('domain')
def test_the_bench_in_its_shortest_form():
    """Truth: relations that hold on any machine. No time is asserted: it is the machine's."""
    from satvib_bringup.live.bench.case import Case
    from satvib_bringup.live.bench.run import bench

    told = []
    cases = [Case(1, 50.0, True, ('separate',), ('single',), 4.0)]
    found = bench(cases, 1, told.append)
    (case,) = found['cases']
    assert set(case['graphs']) == {'bare separate', 'satvib single'}
    assert len(told) == 2
    for graph in case['graphs'].values():
        assert graph['failed'] == []
        figures = graph['median']
        assert 0.0 < figures['p50'] <= figures['p99'] <= figures['p999'] <= figures['most']
        assert 0.0 <= figures['missed'] < 1.0
        assert figures['cpu'] > 0.0
        assert 0.0 < figures['memory'] <= figures['memory_all']
        assert figures['start'] > 0.0
    assert case['graphs']['bare separate']['ratio']['p99'] == 1.0
