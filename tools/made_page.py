# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A page that a tool makes: it is written when it has changed, or only compared."""

from pathlib import Path


def write_or_compare(page: Path, should: str, arguments: list[str], tool: str) -> int:
    """Write the page, or with `--check` say that it is not current; gives the exit code."""
    if page.exists() and page.read_text(encoding='utf-8') == should:
        return 0
    if '--check' in arguments:
        print(f'docs/{page.name} is not current: run python tools/{tool}')
        return 1
    page.write_text(should, encoding='utf-8')
    return 0
