# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Simulated 3-DOF and 1-DOF vibration isolators."""
