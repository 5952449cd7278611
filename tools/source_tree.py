# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The packages of the workspace as their source shows them: rooms, modules, doors, imports, circles.

Nothing is imported; every file is parsed. `tools/write_architecture.py` and `tests/test_architecture.py` use it.
"""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# in the order in which they build on each other
PACKAGES = (
    'satvib_common', 'satvib_ident', 'satvib_control', 'satvib_plant_sim', 'satvib_daq_bridge',
    'satvib_experiment', 'satvib_studies', 'satvib_bringup',
)  # fmt: skip
NO_ALL = object()  # a module without __all__


@dataclass(frozen=True)
class Import:
    """One name that a file imports."""

    module: str  # dotted
    name: str | None  # None for `import module`
    line: int
    when: str  # 'module', 'function', or 'types' inside `if TYPE_CHECKING`
    alias: str | None = None


@dataclass
class Module:
    """One Python file of a package, parsed."""

    path: Path
    name: str  # dotted
    tree: ast.Module = field(repr=False)

    @property
    def is_door(self) -> bool:
        """Whether the file is the `__init__.py` of a room."""
        return self.path.name == '__init__.py'

    @property
    def room(self) -> str:
        """Dotted name of the folder that the file lies in."""
        return self.name if self.is_door else self.name.rpartition('.')[0]

    @property
    def package(self) -> str:
        """Name of the package."""
        return self.name.split('.')[0]

    @property
    def docstring(self) -> str:
        """Docstring of the file."""
        return ast.get_docstring(self.tree) or ''

    @property
    def summary(self) -> str:
        """First sentence of the docstring."""
        return first_sentence(self.docstring)

    @cached_property
    def imports(self) -> list[Import]:
        """Everything that the file imports, wherever it does."""
        return list(_imports(self.tree.body, 'module'))

    @property
    def public(self) -> object:
        """What `__all__` names, in its order; NO_ALL without one."""
        for statement in self.tree.body:
            if isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is not None:
                targets = (
                    statement.targets if isinstance(statement, ast.Assign) else [statement.target]
                )
                if any(isinstance(t, ast.Name) and t.id == '__all__' for t in targets):
                    return list(ast.literal_eval(statement.value))
        return NO_ALL


def first_sentence(text: str) -> str:
    """The first sentence of a docstring, on one line."""
    paragraph = ' '.join(text.strip().split('\n\n')[0].split())
    match = re.match(r'(.+?(?<!Eq)(?<!Eqs)(?<!Fig)(?<!Figs)[.!?])(?:\s+[A-Z`(]|$)', paragraph)
    return match[1] if match else paragraph


def _imports(statements: list[ast.stmt], when: str) -> Iterator[Import]:
    for statement in statements:
        if isinstance(statement, ast.Import):
            for item in statement.names:
                yield Import(item.name, None, statement.lineno, when, item.asname)
        elif isinstance(statement, ast.ImportFrom) and statement.module:
            for item in statement.names:
                yield Import(statement.module, item.name, statement.lineno, when, item.asname)
        elif isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef):
            yield from _imports(statement.body, 'function')
        elif isinstance(statement, ast.If) and ast.unparse(statement.test) == 'TYPE_CHECKING':
            yield from _imports(statement.body, 'types')
            yield from _imports(statement.orelse, when)
        else:
            for part in ('body', 'orelse', 'finalbody'):
                inner = getattr(statement, part, None)
                if isinstance(inner, list):
                    yield from _imports(inner, when)
            for handler in getattr(statement, 'handlers', []):
                yield from _imports(handler.body, when)


@cache
def modules(root: Path = ROOT) -> dict[str, Module]:
    """Every Python file of every package by its dotted name, in the packages' order."""
    found = {}
    for package in PACKAGES:
        folder = root / 'src' / package
        for path in sorted((folder / package).rglob('*.py')):
            parts = path.relative_to(folder).with_suffix('').parts
            name = '.'.join(parts[:-1] if parts[-1] == '__init__' else parts)
            found[name] = Module(path, name, ast.parse(path.read_text(encoding='utf-8')))
    return found


def target(item: Import, known: dict[str, Module]) -> str | None:
    """The module of the workspace that an import loads; None for another library's."""
    if item.name is not None and f'{item.module}.{item.name}' in known:
        return f'{item.module}.{item.name}'
    return item.module if item.module in known else None


def circles(known: dict[str, Module], when: tuple[str, ...] = ('module',)) -> list[list[str]]:
    """Groups of modules that import each other, directly or not (strongly connected components).

    A door loads nothing when it is imported, so an import of a door leads nowhere unless the door itself imports.

    Args:
        known: the modules.
        when: which imports count.
    """
    edges = {
        name: {
            t
            for item in module.imports
            if item.when in when and (t := target(item, known)) not in {None, name}
        }
        for name, module in known.items()
    }
    return [sorted(group) for group in _components(edges) if len(group) > 1]


def _components(edges: dict[str, set[str]]) -> list[list[str]]:
    """Strongly connected components (Tarjan 1972), without recursion."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found = []
    for root in edges:
        if root in index:
            continue
        work = [(root, iter(sorted(edges[root])))]
        index[root] = low[root] = len(index)
        stack.append(root)
        while work:
            node, following = work[-1]
            for after in following:
                if after not in index:
                    index[after] = low[after] = len(index)
                    stack.append(after)
                    work.append((after, iter(sorted(edges[after]))))
                    break
                if after in stack:
                    low[node] = min(low[node], index[after])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    cut = stack.index(node)
                    found.append(stack[cut:])
                    del stack[cut:]
    return found


def tracked_texts(root: Path = ROOT) -> dict[str, str] | None:
    """Every text file that git tracks, by its path from the root; None when this is no git checkout."""
    listed = subprocess.run(
        ['git', 'ls-files', '-z'], cwd=root, capture_output=True, text=True, check=False
    )
    if listed.returncode:
        return None
    paths = [root / name for name in listed.stdout.split('\0') if name]
    return {
        path.relative_to(root).as_posix(): path.read_text(encoding='utf-8', errors='ignore')
        for path in paths
        if path.suffix not in {'.png', '.lock'} and path.is_file()
    }
