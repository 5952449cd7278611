# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Models of a strut: discrete, continuous, their polynomials and their file."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.models.continuous_model import ContinuousModel
    from satvib_ident.models.iir_model import IirModel
    from satvib_ident.models.model_file import load_model, save_model
    from satvib_ident.models.polynomials import pole_modulus, roots

__all__ = [
    'ContinuousModel',
    'IirModel',
    'load_model',
    'pole_modulus',
    'roots',
    'save_model',
]
__getattr__, __dir__ = door(__name__, __file__)
