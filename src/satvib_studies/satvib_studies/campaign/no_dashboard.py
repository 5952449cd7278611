# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Closes the web server of a Dask scheduler or worker, which `--no-dashboard` leaves open on all interfaces.

Dask imports this module where its setting `preload` names it, and calls `dask_setup`
(https://docs.dask.org/en/stable/customize-initialization.html).
"""

from typing import Any


def dask_setup(server: Any) -> None:
    """Close the port."""
    server.http_server.stop()
