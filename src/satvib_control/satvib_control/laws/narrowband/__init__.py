# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The law `narrowband`: tones are found, followed and cancelled."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.laws.narrowband.law import Narrowband
    from satvib_control.laws.narrowband.parameters import NarrowbandParameters

__all__ = [
    'Narrowband',
    'NarrowbandParameters',
]
__getattr__, __dir__ = door(__name__, __file__)
