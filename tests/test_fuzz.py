# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Damaged files of every kind, in small numbers: the long runs are made by `benchmarks/fuzz_*.py`.

Truth: what was written before it was damaged; nothing but one line, a note or the right values may come of it.
"""

import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

BENCHMARKS = Path(__file__).resolve().parents[1] / 'benchmarks'


@pytest.fixture(scope='module')
def scripts():
    """The fuzzing scripts by what they damage."""
    sys.path.insert(0, str(BENCHMARKS))
    yield {name: import_module(f'fuzz_{name}') for name in ('records', 'yaml', 'bags')}
    sys.path.remove(str(BENCHMARKS))


@pytest.mark.parametrize(
    ('kind', 'suffix'), [('records', 'csv'), ('yaml', 'yaml'), ('bags', 'bag')]
)
def test_damaged_files_end_in_one_line_or_in_the_truth(scripts, tmp_path, kind, suffix):
    @settings(
        max_examples=60, deadline=None, derandomize=True, database=None,
        suppress_health_check=[HealthCheck.too_slow],
    )  # fmt: skip
    @given(st.integers(0, 2**32 - 1))
    def check(number):
        generator = np.random.default_rng([number, 9])
        label, what = scripts[kind].trial(generator, tmp_path / f'file.{suffix}')
        assert what[0] not in 'EW', f'{label}: {what}'

    check()
