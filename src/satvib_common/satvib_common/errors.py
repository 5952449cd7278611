# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The one error that people see."""


class SatvibError(Exception):
    """A broken input or set-up, told in one line: what, where, and what to do.

    Commands print it as it is and exit with 2. Anything else that escapes is a defect of satvib.
    """


class RunError(Exception):
    """A run that started and then failed, told in one line. Commands exit with 1."""
