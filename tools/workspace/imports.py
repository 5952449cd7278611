# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a module imports when it is imported, read from the source of `src/`: nothing is run.

Counted are imports that run at import time: not those of functions, nor those for the type checker. A door (an
`__init__.py` that imports a name when it is asked for, from its block `if TYPE_CHECKING:`) is followed for that name.
"""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path


class Sources:
    """The Python modules of a workspace.

    Args:
        src: the folder with the packages.

    Attributes:
        files: module name -> file. Tests, launch files and setup.py are no modules.
    """

    def __init__(self, src: Path) -> None:
        self.files: dict[str, Path] = {}
        for package in sorted(src.glob('*/*/__init__.py')):
            if package.parent.name == package.parent.parent.name:
                for path in package.parent.rglob('*.py'):
                    parts = path.relative_to(package.parent.parent).with_suffix('').parts
                    name = '.'.join(parts[:-1] if parts[-1] == '__init__' else parts)
                    self.files[name] = path
        self._direct = cache(self._read)

    def closure(self, roots: list[str]) -> set[str]:
        """Name all modules of the workspace that are imported with some modules."""
        found: set[str] = set()
        left = list(roots)
        while left:
            name = left.pop()
            if name in self.files and name not in found:
                found.add(name)
                left += [name.rpartition('.')[0], *self._direct(name)]
        return found

    def _read(self, name: str) -> frozenset[str]:
        found = set()
        for node in run_at_import(ast.parse(self.files[name].read_text(encoding='utf-8')).body):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                found.add(node.module)
                for alias in node.names:
                    inner = f'{node.module}.{alias.name}'
                    found.add(
                        inner if inner in self.files else self._behind(node.module, alias.name)
                    )
        return frozenset(found)

    def _behind(self, door: str, name: str) -> str:
        """Name the module behind a door that a name comes from; the door itself when it is none."""
        path = self.files.get(door)
        if path is None or path.name != '__init__.py':
            return door
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            if not isinstance(node, ast.ImportFrom) or not node.module:
                continue
            if any((alias.asname or alias.name) == name for alias in node.names):
                return node.module
        return door


def run_at_import(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """Give the statements that run when the module is imported."""
    for node in body:
        if isinstance(node, ast.If) and 'TYPE_CHECKING' in ast.unparse(node.test):
            yield from run_at_import(node.orelse)
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        else:
            yield node
            for field in ('body', 'orelse', 'finalbody'):
                yield from run_at_import(getattr(node, field, []))
            for handler in getattr(node, 'handlers', []):
                yield from run_at_import(handler.body)
