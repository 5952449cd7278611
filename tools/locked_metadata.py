# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Write requirements/metadata.json: what every locked package requires, on every Python that is promised.

    .venv/bin/python tools/locked_metadata.py

The locks are installed into folders that are thrown away, once for each Python, and their metadata is read there. The
tests prove with it that the locks are closed, without a network, and compare it with what is installed.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from importlib.metadata import Distribution, distributions
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
REQUIREMENTS = ROOT / 'requirements'
UV = ROOT / '.cache' / 'uv' / 'bin' / 'uv'
PYTHONS = (f'{sys.version_info[0]}.{sys.version_info[1]}', '3.11', '3.12', '3.13')
# locks that are installed together, and the Pythons that they are for
GROUPS = (
    (('ros.lock', 'satvib.lock', 'benchmarks.lock'), PYTHONS),
    (('overlay.lock',), ('3.12',)),
    (('build.lock',), PYTHONS),
    (('uv.lock',), PYTHONS),
)


def main() -> int:
    """Write the file.

    Returns:
        an exit code.
    """
    found: dict[str, list[str]] = {}
    # compiled here from source: these cannot be had for another Python, and their metadata is that of the source
    built: set[str] = set()
    for locks, versions in GROUPS:
        for version in versions:
            with tempfile.TemporaryDirectory() as folder:
                install(locks, version, folder, built)
                for distribution in distributions(path=[folder]):
                    if '-linux_x86_64' in (distribution.read_text('WHEEL') or ''):
                        built.add(described(distribution)[0])
                    name, requires = described(distribution)
                    if found.setdefault(name, requires) != requires:
                        found[f'{name} on {version}'] = requires
    lines = [f'{json.dumps(name)}: {json.dumps(found[name])}' for name in sorted(found)]
    (REQUIREMENTS / 'metadata.json').write_text('{\n' + ',\n'.join(lines) + '\n}\n')
    return 0


def install(locks: tuple[str, ...], version: str, folder: str, without: set[str]) -> None:
    """Install locks for a Python into a folder, without some packages."""
    command = [str(UV), 'pip', 'install', '--quiet', '--require-hashes', '--no-build-isolation']
    command += ['--index-strategy', 'unsafe-best-match', '--python', sys.executable]
    command += ['--python-version', version, '--python-platform', 'x86_64-manylinux_2_28']
    command += ['--target', folder]
    if version == f'{sys.version_info[0]}.{sys.version_info[1]}':
        without = set()
    command += ['--no-deps']
    for lock in locks:
        path = Path(folder) / lock
        entries = re.split(r'^(?=\w)', (REQUIREMENTS / lock).read_text(), flags=re.MULTILINE)
        path.write_text(''.join(e for e in entries if e.split(' ')[0] not in without))
        command += ['-r', str(path)]
    subprocess.run(command, check=True, env=os.environ | {'UV_LINK_MODE': 'hardlink'})


def described(distribution: Distribution) -> tuple[str, list[str]]:
    """Give 'name==version' and what it requires."""
    name = distribution.metadata['Name'].lower().replace('_', '-').replace('.', '-')
    return f'{name}=={distribution.version}', sorted(distribution.requires or [])


if __name__ == '__main__':
    sys.exit(main())
