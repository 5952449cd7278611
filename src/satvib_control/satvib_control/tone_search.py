# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Finding tones that nobody tracks yet: a short-time spectrum against its own floor."""
