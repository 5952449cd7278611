# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Subcommands of `satvib`, one per file; heavy modules are imported when a command runs."""

__all__: list[str] = []
