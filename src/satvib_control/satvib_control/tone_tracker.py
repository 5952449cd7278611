# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""An unbiased tracker of the tones of a signal: amplitude, phase, frequency and its rate."""
