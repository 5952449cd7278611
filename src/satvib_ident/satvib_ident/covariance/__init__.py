# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The covariance of an estimate as U D U^T, and the eigenvalues of small matrices."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.covariance.eigenvalues import extreme_eigenvalues, information_measures
    from satvib_ident.covariance.ud import covariance, measure

__all__ = [
    'covariance',
    'extreme_eigenvalues',
    'information_measures',
    'measure',
]
__getattr__, __dir__ = door(__name__, __file__)
