# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The loop on real hardware: channels, calibration, output guard, back ends."""
