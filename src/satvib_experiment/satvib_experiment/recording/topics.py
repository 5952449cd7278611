# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of the graph that are recorded, and the types of their messages."""

# group of a recording: last part of the strut's topic, name of its message
TOPICS = {
    'acceleration': ('acceleration', 'StrutAcceleration'),
    'voltage': ('voltage', 'VcaVoltage'),
    'model': ('identified_model', 'IirParameters'),
    'state': ('controller_state', 'ControllerState'),
    'truth': ('truth', 'StrutTruth'),
}
# topic of a strut: type of its message
STRUT_TOPICS = {topic: f'satvib_msgs/msg/{kind}' for topic, kind in TOPICS.values()}
SHARED_TOPICS = {
    'schedule': 'satvib_msgs/msg/Schedule',
    '/diagnostics': 'diagnostic_msgs/msg/DiagnosticArray',
}
