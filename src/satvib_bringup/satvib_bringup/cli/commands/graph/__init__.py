# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Subcommands that start or look at single nodes and topics of a graph."""

__all__: list[str] = []
