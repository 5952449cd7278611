# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Frequency responses of measured signals: H1, H2, Hv, coherence, and the band in which the truth lies."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.frequency.averaged import averaged_response, averaged_responses
    from satvib_ident.frequency.local import local_response
    from satvib_ident.frequency.periodic import periodic_response, stepped_response
    from satvib_ident.frequency.response import FrequencyResponse
    from satvib_ident.frequency.settings import FrfSettings
    from satvib_ident.frequency.spectra import averaged_spectra

__all__ = [
    'FrequencyResponse',
    'FrfSettings',
    'averaged_response',
    'averaged_responses',
    'averaged_spectra',
    'local_response',
    'periodic_response',
    'stepped_response',
]
__getattr__, __dir__ = door(__name__, __file__)
