# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Make the workspace ready, one step a file; standard library only. `steps.prepare` runs them in order."""
