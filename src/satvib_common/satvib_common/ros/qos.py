# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Quality of service, so that start-up has no race.

Every satvib publisher offers reliable and transient local with a deep history. A reader that needs every
message (the recorder, and in lockstep every node of the loop) asks for transient local, and gets each sample even when
it is discovered late. The others ask for volatile and begin with the present message.
"""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

# Samples. At 1000 samples a second a reader may stop for a second before messages are lost.
DEPTH = 1000

_POLICIES = (
    QoSPolicyKind.HISTORY,
    QoSPolicyKind.DEPTH,
    QoSPolicyKind.RELIABILITY,
    QoSPolicyKind.DURABILITY,
)


def _reliable(
    depth: int,
    durability: DurabilityPolicy,
    history: HistoryPolicy = HistoryPolicy.KEEP_LAST,
) -> QoSProfile:
    return QoSProfile(
        history=history,
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=durability,
    )


def offered(depth: int = DEPTH, paced: bool = False) -> QoSProfile:
    """What a publisher offers; `paced`: it waits for the readers instead of overwriting what they have not received."""
    history = HistoryPolicy.KEEP_ALL if paced else HistoryPolicy.KEEP_LAST
    return _reliable(depth, DurabilityPolicy.TRANSIENT_LOCAL, history)


def volatile(depth: int) -> QoSProfile:
    """What a publisher offers of which only the present counts."""
    return _reliable(depth, DurabilityPolicy.VOLATILE)


def wanted(whole: bool, depth: int = DEPTH) -> QoSProfile:
    """What a reader asks for; `whole`: also what was published before it came."""
    return _reliable(
        depth, DurabilityPolicy.TRANSIENT_LOCAL if whole else DurabilityPolicy.VOLATILE
    )


def overridable() -> QoSOverridingOptions:
    """Let `qos_overrides` parameters change history, depth, reliability and durability."""
    return QoSOverridingOptions(_POLICIES)
