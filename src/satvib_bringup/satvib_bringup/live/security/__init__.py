# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""SROS2 for a graph: who may publish and hear what, and under which enclave a process runs."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.live.security.enclaves import enclave_arguments
    from satvib_bringup.live.security.policy import Rights, policy_of, rights_of

__all__ = ['Rights', 'enclave_arguments', 'policy_of', 'rights_of']
__getattr__, __dir__ = door(__name__, __file__)
