# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rehearsal before a run in real time."""

import pytest
from satvib_ident.identifier import IdentifierCore
from satvib_ident.parameters import IdentifierParameters
from satvib_ident.rehearsal import rehearse


@pytest.mark.parametrize('estimator', ['least_squares', 'extended', 'instrumental'])
def test_the_estimate_is_updated_and_measured(estimator):
    """Truth: the counts; samples are used, and the measures of trust have been looked at."""
    core = IdentifierCore(IdentifierParameters(estimator=estimator, sample_rate=200.0))
    rehearse(core)
    assert core.estimator.updates > 10
    assert core._measured is not None
