# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The law `model_reference`: a PID controller whose gains adapt until the strut behaves like a reference model."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.laws.model_reference.law import ModelReference
    from satvib_control.laws.model_reference.parameters import ModelReferenceParameters

__all__ = [
    'ModelReference',
    'ModelReferenceParameters',
]
__getattr__, __dir__ = door(__name__, __file__)
