# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The comparison of the centralized with the decentralized scheme: cases, runs, tables, figure."""
