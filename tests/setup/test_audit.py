# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The locked packages are pinned, hashed, from an index, and no release with a known weakness.

Truth: the lock files, and the advisories that requirements/denied.txt names. The index is not asked here: the gate runs
without network. `tools/audit.py --online` asks it.
"""

import re

import audit
import pytest
from lock_files import REQUIREMENTS

RANGES = audit.denied((REQUIREMENTS / 'denied.txt').read_text())
LOCKS = sorted(REQUIREMENTS.glob('*.lock'))
GOOD = f'tornado==6.6.1 \\\n    --hash=sha256:{"0" * 64}\n    # via distributed\n'


@pytest.mark.parametrize('lock', LOCKS, ids=lambda path: path.stem)
def test_a_lock_has_nothing_to_complain_of(lock):
    text = lock.read_text()
    assert audit.complaints(text, RANGES) == []
    heads = re.findall(r'^\w.*==', text, re.MULTILINE)
    assert len(list(audit.entries(text))) == len(heads) > 0


@pytest.mark.parametrize(
    ('change', 'said'),
    [
        (('6.6.1', '6.4.0'), 'tornado 6.4.0 is in tornado<6.5.3: CVE-2025-67724'),
        (('==6.6.1', '>=6.6.1'), 'not a pin'),
        (('tornado==6.6.1', 'tornado @ https://example.org/tornado.whl'), 'not a pin'),
        (('tornado==6.6.1', '--index-url https://example.org'), 'not a pin'),
        (('sha256', 'md5'), 'needs SHA-256 hashes'),
        (('    --hash', '# --hash'), 'needs SHA-256 hashes'),
    ],
)
def test_a_lock_that_is_wrong_is_found(change, said):
    assert audit.complaints(GOOD, RANGES) == []
    (line,) = audit.complaints(GOOD.replace(*change), RANGES)
    assert said in line


@pytest.mark.parametrize(
    ('packages', 'code', 'said'),
    [
        ([{'name': 'zipp', 'version': '4.1.2', 'vulns': []}], 0, ''),
        ([{'name': 'zipp', 'skip_reason': 'not found'}], 2, 'tells nothing about its 1 packages'),
        (
            [
                {
                    'name': 'zipp',
                    'version': '3.0',
                    'vulns': [{'id': 'X-1', 'fix_versions': ['3.19.1']}],
                }
            ],
            1,
            'a.lock: zipp 3.0: X-1, fixed in 3.19.1',
        ),
    ],
)
def test_an_index_that_tells_nothing_is_no_clean_bill(packages, code, said, capsys):
    """Truth: the form of pip-audit's JSON. A mirror without advisories makes it skip every package and succeed."""
    assert audit.report('a.lock', packages) == code
    shown = capsys.readouterr()
    assert said in shown.out + shown.err


def test_every_range_has_its_reason():
    assert all(why.startswith('CVE-') for _, why in RANGES)
