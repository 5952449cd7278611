# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What people have set for pip, said to uv.

pip itself is asked what holds (`pip config list`: files of system, user and environment, and `PIP_*`), so its own rules
of precedence are kept. A choice that is made for uv already (`UV_*`, `SSL_CERT_FILE`, proxies) stays.
"""

import ast
import contextlib
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path
from urllib.parse import unquote, urlsplit

# later ones win
SECTIONS = ('global', 'install', ':env:')
LINE = re.compile(r'(?P<section>:env:|[\w-]+)\.(?P<key>[\w-]+)=(?P<value>.*)')


def effective(listing: str) -> dict[str, str]:
    """Read the output of `pip config list`: option name -> value, as `pip install` would take it."""
    found: dict[str, dict[str, str]] = {section: {} for section in SECTIONS}
    for line in listing.splitlines():
        match = LINE.fullmatch(line.strip())
        if match is None or match['section'] not in found:
            continue
        try:
            value = ast.literal_eval(match['value'])
        except (ValueError, SyntaxError):
            continue
        # PIP_DEFAULT_TIMEOUT is the old name of PIP_TIMEOUT; empty values count as not set
        key = match['key'].replace('_', '-').removeprefix('default-')
        if str(value).strip():
            found[match['section']][key] = str(value).strip()
    return {key: value for section in SECTIONS for key, value in found[section].items()}


def is_there(place: str) -> bool:
    """Whether a local folder exists; what is not local counts as there. pip passes by what is not there."""
    parts = urlsplit(place)
    if parts.scheme == 'file':
        return Path(unquote(parts.path)).exists()
    return bool(parts.scheme) or Path(place).expanduser().exists()


def is_true(settings: Mapping[str, str], key: str) -> bool:
    """Whether a switch of pip is on."""
    return settings.get(key, '').lower() in {'1', 'true', 'yes', 'on', 'y', 't'}


def for_uv(settings: Mapping[str, str], environment: Mapping[str, str]) -> dict[str, str]:
    """Say pip's settings in uv's environment variables.

    Args:
        settings: of pip, from `effective`.
        environment: of the process; what is set for uv there is kept.

    Returns:
        variables to add.
    """
    wanted: dict[str, str] = {}
    if is_true(settings, 'no-index'):
        wanted['UV_NO_INDEX'] = '1'
    else:
        if 'index-url' in settings:
            wanted['UV_DEFAULT_INDEX'] = settings['index-url']
        extra = [url for url in settings.get('extra-index-url', '').split() if is_there(url)]
        if extra:
            wanted['UV_INDEX'] = ' '.join(extra)
    links = [place for place in settings.get('find-links', '').split() if is_there(place)]
    if links:
        wanted['UV_FIND_LINKS'] = ','.join(links)
    if 'cert' in settings:
        wanted['SSL_CERT_FILE'] = settings['cert']
    if 'client-cert' in settings:
        wanted['SSL_CLIENT_CERT'] = settings['client-cert']
    if 'trusted-host' in settings:
        wanted['UV_INSECURE_HOST'] = ' '.join(settings['trusted-host'].split())
    if 'proxy' in settings:
        wanted['HTTP_PROXY'] = wanted['HTTPS_PROXY'] = settings['proxy']
    if settings.get('timeout', '').replace('.', '', 1).isdigit():
        wanted['UV_HTTP_TIMEOUT'] = str(max(1, round(float(settings['timeout']))))
    if is_true(settings, 'no-cache-dir'):
        wanted['UV_NO_CACHE'] = '1'
    older = {'UV_DEFAULT_INDEX': 'UV_INDEX_URL', 'UV_INDEX': 'UV_EXTRA_INDEX_URL'}
    # pip takes its own proxy and certificate before those of the environment
    firm = {'HTTP_PROXY', 'HTTPS_PROXY', 'SSL_CERT_FILE', 'SSL_CLIENT_CERT'}
    result = {
        name: value
        for name, value in wanted.items()
        if name in firm or not (environment.get(name) or environment.get(older.get(name, '')))
    }
    # uv reads the small names of the proxies first
    for name in ('HTTP_PROXY', 'HTTPS_PROXY'):
        if name in result:
            result[name.lower()] = result[name]
    return result


def uv_cache(environment: Mapping[str, str], fallback: Path) -> dict[str, str]:
    """Let uv keep its downloads where it always does, or, when that cannot be written, in the workspace."""
    if environment.get('UV_CACHE_DIR') or environment.get('UV_NO_CACHE'):
        return {}
    home = environment.get('XDG_CACHE_HOME') or environment.get('HOME')
    if home:
        folder = Path(home) if environment.get('XDG_CACHE_HOME') else Path(home) / '.cache'
        # asked by doing it: permissions say yes to root, and to everybody on a disk that is mounted read-only
        with contextlib.suppress(OSError):
            (folder / 'uv').mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder / 'uv'):
                return {}
    return {'UV_CACHE_DIR': str(fallback)}
