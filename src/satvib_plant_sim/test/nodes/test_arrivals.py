# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The arrivals of voltages. Truth: what was noted, by hand."""

import numpy as np
import pytest
from satvib_common.errors import RunError
from satvib_plant_sim.nodes import arrivals as module
from satvib_plant_sim.nodes.arrivals import Arrivals


@pytest.mark.parametrize('block', [1, 7, 1000])
def test_all_arrivals_are_in_the_file(tmp_path, monkeypatch, block):
    """Whatever the size of a block is; a file of an earlier run is replaced, and only the result stays."""
    monkeypatch.setattr(module, '_BLOCK', block)
    path = tmp_path / 'arrivals.npz'
    for count in (5, 40):
        noted = Arrivals(str(path))
        for k in range(count):
            noted.published(k)
            noted.arrived(0, k)
            noted.arrived(1, k)
        noted.arrived(0, count)  # the answer to a sample that was not published
        noted.save(3)
        found = np.load(path)
        expected = [(strut, k) for k in range(count) for strut in (0, 1)]
        assert found['voltages'][:, :2].tolist() == [list(row) for row in expected]
        assert (found['voltages'][:, 2] >= 0.0).all()
        assert int(found['late_samples']) == 3
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_no_arrivals(tmp_path):
    noted = Arrivals(str(tmp_path / 'arrivals.npz'))
    noted.save(0)
    assert np.load(tmp_path / 'arrivals.npz')['voltages'].shape == (0, 3)


def test_a_file_that_cannot_be_written_is_one_line(tmp_path):
    noted = Arrivals(str(tmp_path / 'nowhere' / 'arrivals.npz'))
    with pytest.raises(RunError, match='cannot be written: No such file'):
        noted.save(0)


def test_without_a_file_nothing_is_noted(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / '.part').write_text('of somebody else')
    noted = Arrivals('')
    noted.published(0)
    noted.arrived(0, 0)
    noted.save(0)
    assert [p.name for p in tmp_path.iterdir()] == ['.part']
