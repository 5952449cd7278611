# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Laws judged as isolators: transmissibility under random base motion, line of sight while a wheel runs up."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.isolation.cases import Isolation, load_isolation
    from satvib_studies.isolation.figure import draw
    from satvib_studies.isolation.numbers import Judged, judged
    from satvib_studies.isolation.runs import LawFound, run_isolation, run_law
    from satvib_studies.isolation.tables import page_tables, plain

__all__ = [
    'Isolation',
    'Judged',
    'LawFound',
    'draw',
    'judged',
    'load_isolation',
    'page_tables',
    'plain',
    'run_isolation',
    'run_law',
]
__getattr__, __dir__ = door(__name__, __file__)
