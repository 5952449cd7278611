# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Front doors: the `__init__.py` of a room lists what is public, and a name is imported when it is asked for.

A door imports its names for the type checker only:

    if TYPE_CHECKING:
        from satvib_control.laws.base import BasicLaw, LawInput

    __all__ = ['BasicLaw', 'LawInput']
    __getattr__, __dir__ = door(__name__, __file__)

At run time `door` reads that block when the first name is asked for. So a door costs nothing to those who import a
module behind it, and modules behind a door may import each other without a circle.
"""

import ast
import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any


def door(name: str, file: str) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Make `__getattr__` and `__dir__` of a package.

    Args:
        name: of the package.
        file: its `__init__.py`, which is read.
    """
    places: dict[str, tuple[str, str]] = {}

    def known() -> dict[str, tuple[str, str]]:
        if not places:
            places.update(public_names(Path(file).read_text(encoding='utf-8')))
        return places

    def get(wanted: str) -> Any:
        if wanted.startswith('__') or wanted not in known():
            raise AttributeError(f'module {name!r} has no attribute {wanted!r}')
        module, original = known()[wanted]
        return getattr(importlib.import_module(module), original)

    def names() -> list[str]:
        return sorted(known())

    return get, names


def public_names(source: str) -> dict[str, tuple[str, str]]:
    """Read the block `if TYPE_CHECKING:` of a door: public name to module and name there."""
    found = {}
    for block in ast.parse(source).body:
        if isinstance(block, ast.If) and ast.unparse(block.test) == 'TYPE_CHECKING':
            for line in block.body:
                if isinstance(line, ast.ImportFrom) and line.module:
                    for item in line.names:
                        found[item.asname or item.name] = (line.module, item.name)
    return found
