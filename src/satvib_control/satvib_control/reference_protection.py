# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The strut's own reaction in the reference, and how it is taken off."""
