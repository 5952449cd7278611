# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Commands that measure what an isolator is judged by."""

__all__: list[str] = []
