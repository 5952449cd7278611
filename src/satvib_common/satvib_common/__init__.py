# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What every package shares: phases, schemas, settings, the voltage guard and the types of arrays."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.arrays import Array, Complex, Integers, Mask
    from satvib_common.errors import RunError, SatvibError
    from satvib_common.files.yaml_file import load_yaml, parse_yaml
    from satvib_common.guard import Guarded, VoltageGuard
    from satvib_common.levels import decibel, rms, rms_with_mean
    from satvib_common.parameters import LoopParameters
    from satvib_common.phases import Phase, PhasePlan
    from satvib_common.schema import Schema, param
    from satvib_common.sequence import Arrival, SequenceTracker
    from satvib_common.settings_text import (
        change_settings,
        parse_setting,
        parse_settings,
        setting_text,
    )

__all__ = [
    'Array',
    'Arrival',
    'Complex',
    'Guarded',
    'Integers',
    'LoopParameters',
    'Mask',
    'Phase',
    'PhasePlan',
    'RunError',
    'SatvibError',
    'Schema',
    'SequenceTracker',
    'VoltageGuard',
    'change_settings',
    'decibel',
    'load_yaml',
    'param',
    'parse_setting',
    'parse_settings',
    'parse_yaml',
    'rms',
    'rms_with_mean',
    'setting_text',
]
__getattr__, __dir__ = door(__name__, __file__)
