# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Audit the locked packages: pins, hashes and sources, releases with a known weakness, and what the index knows now.

    python tools/audit.py              # without network; tests/setup/test_audit.py runs it in every gate
    python tools/audit.py --online     # also with pip-audit, in an environment of its own

Without network a lock is read: every package has one version and SHA-256 hashes, comes from an index and not from an
address, and is no release that requirements/denied.txt names. Exit code 1: something was found; 2: nobody to ask.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

REQUIREMENTS = Path(__file__).resolve().parents[1] / 'requirements'
_PIN = re.compile(
    r'^(?P<name>[\w.-]+)(?:\[[^\]]*\])?==(?P<version>[\w.+!-]+)(?:\s*;[^\\]*)?\s*\\?$'
)
_HASH = re.compile(r'^--hash=sha256:[0-9a-f]{64}\s*\\?$')


def entries(text: str) -> Iterator[tuple[str, list[str]]]:
    """The entries of a lock: the first line, and the others that are no comments."""
    head, more = '', []
    for line in text.splitlines():
        if not line.strip() or line.lstrip().startswith('#'):
            continue
        if line[0].isspace():
            more.append(line.strip())
            continue
        if head:
            yield head, more
        head, more = line, []
    if head:
        yield head, more


def denied(text: str) -> list[tuple[Requirement, str]]:
    """The ranges of a list of denied releases, each with its reason."""
    found = []
    for line in text.splitlines():
        what, _, why = line.partition('#')
        if what.strip():
            found.append((Requirement(what.strip()), why.strip()))
    return found


def complaints(lock: str, ranges: Iterable[tuple[Requirement, str]]) -> list[str]:
    """What is wrong with a lock."""
    ranges = list(ranges)
    found = []
    for head, more in entries(lock):
        pin = _PIN.match(head)
        if pin is None:
            found.append(f'{head.split()[0]}: not a pin of one version from an index')
            continue
        if not more or not all(_HASH.match(line) for line in more):
            found.append(f'{pin["name"]}: needs SHA-256 hashes and nothing else')
        found += [
            f'{pin["name"]} {pin["version"]} is in {asked}: {why}'
            for asked, why in ranges
            if canonicalize_name(asked.name) == canonicalize_name(pin['name'])
            and asked.specifier.contains(pin['version'], prereleases=True)
        ]
    return found


def ask_index(locks: list[Path]) -> int:
    """Run pip-audit on the locks; gives its exit code, 2 when it cannot be had or reaches no source."""
    with tempfile.TemporaryDirectory() as folder:
        python = Path(folder, 'bin', 'python')
        subprocess.run([sys.executable, '-m', 'venv', folder], check=True)
        made = subprocess.run([python, '-m', 'pip', 'install', '--quiet', 'pip-audit'], check=False)
        if made.returncode:
            return 2
        code = 0
        for lock in locks:
            words = [
                python,
                '-m',
                'pip_audit',
                '--disable-pip',
                '--require-hashes',
                '--format',
                'json',
            ]
            words += ['--progress-spinner', 'off', '--requirement', lock]
            done = subprocess.run(words, capture_output=True, text=True, check=False)
            if not done.stdout:
                print(done.stderr.strip().splitlines()[-1], file=sys.stderr)
                return 2
            code = max(code, report(lock.name, json.loads(done.stdout)['dependencies']))
        return code


def report(lock: str, packages: list[dict[str, Any]]) -> int:
    """Print what pip-audit found; gives the exit code, 2 where the index told nothing about any package."""
    known = [package for package in packages if 'skip_reason' not in package]
    for package in known:
        for found in package['vulns']:
            fixed = ', '.join(found['fix_versions']) or 'nowhere yet'
            print(
                f'{lock}: {package["name"]} {package["version"]}: {found["id"]}, fixed in {fixed}'
            )
    if not known:
        print(
            f'{lock}: the index tells nothing about its {len(packages)} packages', file=sys.stderr
        )
        return 2
    return 1 if any(package['vulns'] for package in known) else 0


def main() -> int:
    """Read all locks; gives the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--online', action='store_true', help='also ask the index, with pip-audit')
    given = parser.parse_args()
    ranges = denied((REQUIREMENTS / 'denied.txt').read_text(encoding='utf-8'))
    locks = sorted(REQUIREMENTS.glob('*.lock'))
    found = [
        f'{path.name}: {text}'
        for path in locks
        for text in complaints(path.read_text(encoding='utf-8'), ranges)
    ]
    for line in found:
        print(line)
    if found:
        return 1
    return ask_index(locks) if given.online else 0


if __name__ == '__main__':
    sys.exit(main())
