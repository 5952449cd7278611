# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Write the list of rooms and modules into docs/architecture.md, from the docstrings of the doors and the modules.

python tools/write_architecture.py            # write the page
python tools/write_architecture.py --check    # exit code 1 when the page is not current
"""

import sys
from collections.abc import Mapping
from pathlib import Path

from made_page import write_or_compare
from source_tree import NO_ALL, PACKAGES, ROOT, Module, modules

PAGE = ROOT / 'docs' / 'architecture.md'
BEGIN, END = '<!-- rooms: written by tools/write_architecture.py -->', '<!-- end of rooms -->'


def rooms_text(known: Mapping[str, Module]) -> str:
    """The list, as Markdown: a section per package, a table per room."""
    parts = []
    for package in PACKAGES:
        doors = [m for m in known.values() if m.is_door and m.package == package]
        for door in doors:
            inner = [m for m in known.values() if not m.is_door and m.room == door.name]
            place = '/'.join(door.name.split('.')[1:])
            head = f'**`{place}/`** {door.summary}' if place else f'### {package}\n\n{door.summary}'
            parts.append(head + _public(door))
            if inner:
                rows = [f'| `{m.name.rpartition(".")[2]}` | {_cell(m.summary)} |' for m in inner]
                parts.append('\n'.join(['| module | what |', '|---|---|', *rows]))
    return '\n\n'.join(parts)


def _public(door: Module) -> str:
    public = door.public
    if public is NO_ALL or not isinstance(public, list) or not public:
        return ''
    return f' Public: {", ".join(f"`{name}`" for name in public)}.'


def _cell(text: str) -> str:
    return text.replace('|', '\\|')


def current(page: Path = PAGE) -> tuple[str, str]:
    """The page as it is and as it should be."""
    text = page.read_text(encoding='utf-8')
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    return text, f'{before}{BEGIN}\n\n{rooms_text(modules())}\n\n{END}{after}'


def main(arguments: list[str]) -> int:
    """Write the page, or compare it."""
    return write_or_compare(PAGE, current()[1], arguments, 'write_architecture.py')


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
