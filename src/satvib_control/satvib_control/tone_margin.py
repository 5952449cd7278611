# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The largest sensitivity of a set of resonators on a model, sample by sample."""
