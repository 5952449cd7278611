# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How well each excitation signal identifies a strut."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.signal_study.study import StudySettings, run

__all__ = [
    'StudySettings',
    'run',
]
__getattr__, __dir__ = door(__name__, __file__)
