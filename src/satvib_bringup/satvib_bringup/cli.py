# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The `satvib` command."""


def main() -> None:
    """Entry point of the `satvib` command."""
