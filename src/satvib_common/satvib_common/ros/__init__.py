# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Helpers of the node shells: the only part of this package that knows ROS."""
