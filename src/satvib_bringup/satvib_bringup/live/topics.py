# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of the graph and the types of their messages."""

# Topics of a strut that are recorded, and the type of their messages.
STRUT_TOPICS = {
    'acceleration': 'satvib_msgs/msg/StrutAcceleration',
    'voltage': 'satvib_msgs/msg/VcaVoltage',
    'identified_model': 'satvib_msgs/msg/IirParameters',
    'controller_state': 'satvib_msgs/msg/ControllerState',
    'truth': 'satvib_msgs/msg/StrutTruth',
}
SHARED_TOPICS = {
    'schedule': 'satvib_msgs/msg/Schedule',
    '/diagnostics': 'diagnostic_msgs/msg/DiagnosticArray',
}
