# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Reads lock files, and walks what the locked packages ask for."""

import json
import re
from pathlib import Path

from packaging.markers import Marker, default_environment
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent.parent
REQUIREMENTS = ROOT / 'requirements'
ENTRY = re.compile(
    r'^(?P<name>[\w.-]+)(?:\[(?P<extras>[^\]]*)\])?==(?P<version>[^\s;\\]+)(?:\s*;\s*(?P<marker>[^\\\n]+))?',
    re.MULTILINE,
)


def environment(python):
    """The markers' environment of a Python on the promised machine."""
    return default_environment() | {
        'implementation_name': 'cpython',
        'platform_python_implementation': 'CPython',
        'implementation_version': f'{python}.0',
        'os_name': 'posix',
        'platform_machine': 'x86_64',
        'platform_system': 'Linux',
        'python_full_version': f'{python}.0',
        'python_version': python,
        'sys_platform': 'linux',
    }


def entries(text, python):
    """What a lock pins on a Python: (name, extras) -> version."""
    found = {}
    for match in ENTRY.finditer(text):
        marker = match['marker']
        if marker and not Marker(marker.strip()).evaluate(environment(python)):
            continue
        extras = frozenset(filter(None, re.split(r'[,\s]+', match['extras'] or '')))
        found[canonicalize_name(match['name']), extras] = match['version']
    return found


def read(names):
    return '\n'.join((REQUIREMENTS / name).read_text() for name in names)


def metadata(python):
    """What every locked package requires on a Python: 'name==version' -> requirements."""
    found = json.loads((REQUIREMENTS / 'metadata.json').read_text())
    suffix = f' on {python}'
    special = {k.removesuffix(suffix): v for k, v in found.items() if k.endswith(suffix)}
    return {k: v for k, v in found.items() if ' on ' not in k} | special


def open_ends(text, python):
    """What can be asked for and is not in the lock, exactly as it is asked for.

    An extra counts only when its own line is there with the same extras: pip before 24 takes `name[extra]` for another
    package than `name`, and pins one without the other.
    """
    pins = entries(text, python)
    versions = {name: version for (name, _), version in pins.items()}
    required = metadata(python)
    found = []
    for (name, extras), version in pins.items():
        for line in required[f'{name}=={version}']:
            asked = Requirement(line)
            wanted = any(
                asked.marker is None
                or asked.marker.evaluate(environment(python) | {'extra': extra})
                for extra in extras | {''}
            )
            if not wanted:
                continue
            key = canonicalize_name(asked.name)
            pinned = key in versions and asked.specifier.contains(versions[key], prereleases=True)
            with_extras = not asked.extras or (key, frozenset(asked.extras)) in pins
            if not (pinned and with_extras):
                found.append(f'{name} asks for {asked}')
    return sorted(set(found))
