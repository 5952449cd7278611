# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The locks are closed: nothing can be asked for that is not in them, on any promised Python.

Truth: the packages' own metadata. `tools/lock` keeps it in requirements/metadata.json, so that the test needs neither
network nor the other Pythons; here it is compared with what is installed for the Python that runs.
"""

import re
import sys
from importlib.metadata import distributions

import pytest
from lock_files import entries, metadata, open_ends, read
from packaging.utils import canonicalize_name

PYTHONS = ['3.11', '3.12', '3.13']
GROUPS = [('ros.lock', 'satvib.lock'), ('ros.lock', 'satvib.lock', 'benchmarks.lock')]
ALONE = [('build.lock',), ('uv.lock',)]
CASES = [(group, python) for group in GROUPS + ALONE for python in PYTHONS]
# NumPy 1, which an installed ROS 2 Jazzy was built for, and Ubuntu 24.04's Python
CASES.append((('overlay.lock',), '3.12'))


def without_extras(text):
    """The locks as they once were: the lines of extras lost their extras."""
    return re.sub(r'^([\w.-]+)\[[^\]]*\]==', r'\1==', text, flags=re.MULTILINE)


@pytest.mark.parametrize(
    ('group', 'python'), CASES, ids=lambda v: v if isinstance(v, str) else '+'.join(v)
)
def test_nothing_outside_the_lock_can_be_asked_for(group, python):
    assert open_ends(read(group), python) == []


@pytest.mark.parametrize('python', PYTHONS)
def test_a_lock_without_its_extras_is_found_open(python):
    """This shape did not install with pip before 24 once a newer coverage was out."""
    found = open_ends(without_extras(read(GROUPS[0])), python)
    assert 'pytest-cov asks for coverage[toml]>=7.10.6' in found


@pytest.mark.parametrize('name', ['llvmlite', 'ros-rcl', 'pluggy', 'tzdata'])
def test_a_lock_without_a_package_is_found_open(name):
    """Every one of these is there because another one asks for it."""
    entry = re.compile(rf'^{re.escape(name)}==.*?(?=^\w|\Z)', re.MULTILINE | re.DOTALL)
    text, removed = entry.subn('', read(GROUPS[0]))
    assert removed
    assert any(f'asks for {name}' in line for line in open_ends(text, '3.11'))


def test_what_is_installed_says_what_the_metadata_says():
    """For the Python that runs; `tools/every_python` runs it on all of them."""
    python = f'{sys.version_info[0]}.{sys.version_info[1]}'
    known = metadata(python)
    pins = {name: version for (name, _), version in entries(read(GROUPS[0]), python).items()}
    compared = 0
    for distribution in distributions():
        name = canonicalize_name(distribution.metadata['Name'])
        if pins.get(name) == distribution.version:
            compared += 1
            assert (
                sorted(distribution.requires or []) == known[f'{name}=={distribution.version}']
            ), name
    if compared < len(pins) // 2:
        pytest.skip(
            'the locks are not what is installed here (a sourced ROS 2, or another environment)'
        )
    assert compared >= len(pins)


def test_every_source_package_is_built_with_the_locked_tools():
    """Truth: set-up builds without isolation, so setuptools must have one version in all locks."""
    wanted = entries(read(['build.lock']), '3.11')['setuptools', frozenset()]
    for name in ('ros.lock', 'overlay.lock'):
        assert entries(read([name]), '3.12')['setuptools', frozenset()] == wanted
