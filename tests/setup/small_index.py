# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A package index of small wheels on disk, and a lock of them, in the shape of the real locks.

Of every package that is asked for with an extra in the real locks, of those who ask, and of what the extra brings,
there is an empty wheel with the real name, version and requirements among these packages; and of every one that is
asked for with an extra, a newer release lies beside it.
"""

import base64
import hashlib
import zipfile

from lock_files import entries, metadata
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

NEWER = '99999'


def wheel(folder, name, version, requires, extras=()):
    """Write a wheel without code; gives its SHA-256."""
    stem = f'{name.replace("-", "_")}-{version}'
    lines = ['Metadata-Version: 2.1', f'Name: {name}', f'Version: {version}']
    lines += [f'Provides-Extra: {extra}' for extra in sorted(extras)]
    lines += [f'Requires-Dist: {line}' for line in requires]
    files = {
        f'{stem}.dist-info/METADATA': '\n'.join(lines) + '\n',
        f'{stem}.dist-info/WHEEL': 'Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n',
    }
    record = [
        f'{path},sha256={base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).rstrip(b"=").decode()},{len(text)}'
        for path, text in files.items()
    ]
    files[f'{stem}.dist-info/RECORD'] = '\n'.join([*record, f'{stem}.dist-info/RECORD,,']) + '\n'
    path = folder / f'{stem}-py3-none-any.whl'
    with zipfile.ZipFile(path, 'w') as archive:
        for place, text in files.items():
            archive.writestr(place, text)
    return hashlib.sha256(path.read_bytes()).hexdigest()


def small_index(folder, text, python):
    """Write the wheels.

    Args:
        folder: for the wheels.
        text: of the real locks.
        python: whose lines of the locks count.

    Returns:
        the small lock, and the names that have a newer release.
    """
    pins = entries(text, python)
    versions = {name: version for (name, _), version in pins.items()}
    required = metadata(python)
    asked = {name: extras for name, extras in pins if extras}
    chosen = set(asked)
    for name, version in versions.items():
        for line in required[f'{name}=={version}']:
            requirement = Requirement(line)
            other = canonicalize_name(requirement.name)
            if requirement.extras and other in asked:
                chosen.add(name)
            if name in asked and 'extra' in line and other in versions:
                chosen.add(other)
    lines = []
    for name in sorted(chosen):
        kept = [
            line
            for line in required[f'{name}=={versions[name]}']
            if canonicalize_name(Requirement(line).name) in chosen
        ]
        extras = asked.get(name, frozenset())
        digest = wheel(folder, name, versions[name], kept, extras)
        label = f'{name}[{",".join(sorted(extras))}]' if extras else name
        lines.append(f'{label}=={versions[name]} --hash=sha256:{digest}')
        if extras:
            wheel(folder, name, NEWER, kept, extras)
    return '\n'.join(lines) + '\n', set(asked)
