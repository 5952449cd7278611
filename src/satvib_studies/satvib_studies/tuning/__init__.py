# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Tuning of the centralized law: perturbed plants, their cost under given gains, and the search for the best gains."""
