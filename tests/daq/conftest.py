# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The stand as a fixture, in a ROS domain of its own."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from stand import Stand


@pytest.fixture
def stand(domain, tmp_path):  # noqa: ARG001 - the domain is in the environment
    made = Stand(tmp_path)
    yield made
    made.close()
