# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Readers of the files that labs have, one module a format: each gives the same channels, and none judges them."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.records.formats.channels import Channel, Channels
    from satvib_common.records.formats.kinds import FORMATS, Format, format_of
    from satvib_common.records.formats.labview import read_labview

__all__ = [
    'FORMATS',
    'Channel',
    'Channels',
    'Format',
    'format_of',
    'read_labview',
]
__getattr__, __dir__ = door(__name__, __file__)
