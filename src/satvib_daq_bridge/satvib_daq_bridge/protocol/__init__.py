# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The serial protocol between a bridge and a microcontroller; specified in docs/serial_protocol.md."""
