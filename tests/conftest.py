# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the system tests: real processes, real DDS, a domain of its own for every test (`processes`)."""

import importlib.util
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from processes import Probe, Starter, own_domain

HAS_ROS = importlib.util.find_spec('satvib_msgs') is not None and 'AMENT_PREFIX_PATH' in os.environ


def pytest_configure(config: pytest.Config) -> None:
    """The message generator that comes with ROS uses a module that Python 3.11 deprecates."""
    for module in ('sre_parse', 'sre_constants'):
        config.addinivalue_line(
            'filterwarnings', f"ignore:module '{module}' is deprecated:DeprecationWarning"
        )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Live tests need the built and sourced workspace."""
    skip = pytest.mark.skip(reason='the workspace is not built and sourced; use ./satvib test')
    for item in items:
        if 'live' in Path(str(item.fspath)).name and not HAS_ROS:
            item.add_marker(skip)


@pytest.fixture(scope='session')
def new_domain() -> Callable[[Path], Any]:
    """The context manager, for runs that serve several tests."""
    return own_domain


@pytest.fixture
def domain(tmp_path: Path) -> Iterator[None]:
    """A domain for one test."""
    with own_domain(tmp_path):
        yield


@pytest.fixture
def start(domain: None, tmp_path: Path) -> Iterator[Starter]:  # noqa: ARG001
    """Start nodes: start(package, executable, namespace='/', **parameters)."""
    starter = Starter(tmp_path)
    yield starter
    starter.close()


@pytest.fixture
def probe(domain: None) -> Iterator[Probe]:  # noqa: ARG001
    """A node of the test."""
    made = Probe()
    yield made
    made.close()
