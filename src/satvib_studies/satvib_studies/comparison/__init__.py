# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The decentralized scheme against the centralized one, on the same drawn rigs."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.comparison.cases import Comparison, load_comparison
    from satvib_studies.comparison.runs import run_comparison

__all__ = [
    'Comparison',
    'load_comparison',
    'run_comparison',
]
__getattr__, __dir__ = door(__name__, __file__)
