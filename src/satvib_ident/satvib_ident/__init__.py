# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""On-line identification of each strut by recursive least squares."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.excitation.factory import make_excitation
    from satvib_ident.identifier import Identification, IdentifierCore
    from satvib_ident.models.iir_model import IirModel
    from satvib_ident.models.model_file import load_model, save_model
    from satvib_ident.offline.order_search import identify
    from satvib_ident.parameters import IdentifierParameters

__all__ = [
    'Identification',
    'IdentifierCore',
    'IdentifierParameters',
    'IirModel',
    'identify',
    'load_model',
    'make_excitation',
    'save_model',
]
__getattr__, __dir__ = door(__name__, __file__)
