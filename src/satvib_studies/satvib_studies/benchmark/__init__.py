# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Benchmarks that tests run in a short form: their scripts in `benchmarks/` only print."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.benchmark.active_suspension import Trials
    from satvib_studies.benchmark.robustness import TrialResults, scenario_of

__all__ = ['TrialResults', 'Trials', 'scenario_of']
__getattr__, __dir__ = door(__name__, __file__)
