# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Keys with which a Dask scheduler, its workers and a campaign know one another: one file of Dask's settings.

Every machine gets the same file and `DASK_CONFIG=<file>`. From then on Dask speaks TLS 1.3 only, takes nobody without
the key, and closes the ports of its web pages (`no_dashboard`). Who has the file can run code on the workers.

Source: https://distributed.dask.org/en/stable/tls.html
"""

import os
import subprocess
import tempfile
from pathlib import Path

import yaml
from satvib_common.errors import SatvibError

_DAYS = 365
_NO_PORT = ['satvib_studies.campaign.no_dashboard']
_HEAD = """\
# Keys of a Dask scheduler, its workers and the campaigns on them; whoever has this file can run code there.
# On every machine: export DASK_CONFIG=<this file>
"""


def write_keys(path: Path) -> None:
    """Make a key and write the settings, for the eyes of the owner alone.

    Args:
        path: of the new file.

    Raises:
        SatvibError: it exists, cannot be written, or the program openssl is missing.
    """
    key, certificate = _make()
    pair = {'key': key, 'cert': certificate}
    settings = {
        'distributed': {
            'comm': {
                'require-encryption': True,
                'tls': {
                    'ca-file': certificate,
                    'min-version': 1.3,
                    'scheduler': pair,
                    'worker': dict(pair),
                    'client': dict(pair),
                },
            },
            'scheduler': {'preload': _NO_PORT, 'http': {'routes': []}},
            'worker': {'preload': list(_NO_PORT), 'http': {'routes': []}},
        }
    }
    text = _HEAD + yaml.safe_dump(settings, sort_keys=False)
    try:
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        raise SatvibError(f'{path}: exists already, not overwritten') from None
    except OSError as error:
        raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None
    with os.fdopen(descriptor, 'w', encoding='utf-8') as file:
        file.write(text)


def _make() -> tuple[str, str]:
    """Give a private key and its certificate, which it has signed itself, as PEM."""
    with tempfile.TemporaryDirectory() as folder:
        key, certificate = Path(folder, 'key.pem'), Path(folder, 'certificate.pem')
        command = [
            'openssl', 'req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes',
            '-days', str(_DAYS), '-subj', '/CN=satvib', '-keyout', str(key), '-out', str(certificate),
        ]  # fmt: skip
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        except FileNotFoundError:
            raise SatvibError('openssl is missing: apt install openssl') from None
        if done.returncode:
            said = (done.stderr.strip().splitlines() or ['it says nothing'])[-1]
            raise SatvibError(f'openssl: no key was made: {said}')
        return key.read_text(encoding='ascii'), certificate.read_text(encoding='ascii')
