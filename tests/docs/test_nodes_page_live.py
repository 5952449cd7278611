# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""docs/nodes.md is what the nodes say of themselves."""

import subprocess
import sys

import pytest
from source_tree import ROOT


@pytest.mark.usefixtures('domain')
def test_the_page_of_the_nodes_is_current():
    """Truth: every node, made and asked for its topics, services, qualities of service and parameters."""
    done = subprocess.run(
        [sys.executable, str(ROOT / 'tools/write_nodes.py'), '--check'],
        capture_output=True, text=True, timeout=250.0, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
