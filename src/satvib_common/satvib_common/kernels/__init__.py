# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Compiled functions that several packages use, and how a kernel is compiled and cached."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.kernels.compile import kernel
    from satvib_common.kernels.direct_form import filter_sample
    from satvib_common.kernels.horner_rule import horner, polynomial
    from satvib_common.kernels.ordered_dot import dot, dot_of
    from satvib_common.kernels.schur_cohn import inside_circle, inside_unit_circle
    from satvib_common.kernels.ud import measure_one

__all__ = [
    'dot',
    'dot_of',
    'filter_sample',
    'horner',
    'inside_circle',
    'inside_unit_circle',
    'kernel',
    'measure_one',
    'polynomial',
]
__getattr__, __dir__ = door(__name__, __file__)
