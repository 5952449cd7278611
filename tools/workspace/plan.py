# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which kernels are compiled, and in what order."""

import enum
import re
import threading
from collections.abc import Mapping
from pathlib import Path

from workspace.base import ROOT
from workspace.imports import Sources

KERNEL = re.compile(r'^\s*(?:@|.*=\s*)kernel\(', re.MULTILINE)
COMPILED = re.compile(r'\bn?jit\b|kernel\(')
ENTRY = re.compile(r"=\s*([\w.]+_node):main'")
# the scenarios of the demo are loaded, and their laws with them
SCENARIO = (
    'from satvib_experiment.report import comparison; from satvib_experiment import load_scenario; '
    '[load_scenario(name) for name in ("paper_3dof", *comparison.BESIDE)]'
)


class Need(enum.Enum):
    """What a command needs of the kernels."""

    NOTHING = 'nothing'
    DEMO = 'demo'
    ALL = 'all'


def need_of(command: str = '', *more: str) -> Need:
    """Tell how much the words after `satvib` need. A help text computes nothing."""
    tells = command in {'', 'scenarios', 'rigs', 'shell'} or command.startswith('-')
    if tells or '--help' in more:
        return Need.NOTHING
    return Need.DEMO if command == 'demo' else Need.ALL


class Plan:
    """Tasks that wait for one another, for several workers.

    Args:
        after: task -> the tasks that must be done before it.
        weight: task -> how long it may take; the heaviest that is ready goes first.

    A kernel that two modules need is compiled by the first, and the second would wait for it and do nothing: so a
    module is ready when the kernels that it imports are compiled.
    """

    def __init__(self, after: Mapping[str, set[str]], weight: Mapping[str, float]) -> None:
        self._after = {task: set(before) & set(after) - {task} for task, before in after.items()}
        self._weight, self._count = weight, len(self._after)
        self._at_work: set[str] = set()
        self._changed = threading.Condition()

    def take(self) -> str | None:
        """Give the next task, when one is ready; none when all are taken."""
        with self._changed:
            while waiting := [task for task in self._after if task not in self._at_work]:
                ready = [task for task in waiting if not self._after[task]]
                # a circle of imports: somebody has to begin
                if not ready and not self._at_work:
                    ready = waiting
                if ready:
                    task = max(ready, key=lambda name: self._weight[name])
                    self._at_work.add(task)
                    return task
                self._changed.wait()
            return None

    def done(self, task: str) -> None:
        """Count a task as done."""
        with self._changed:
            self._at_work.discard(task)
            self._after.pop(task, None)
            for before in self._after.values():
                before.discard(task)
            self._changed.notify_all()

    @property
    def share(self) -> float:
        """Share of the tasks that are done, 0 to 1."""
        with self._changed:
            return 1.0 - len(self._after) / max(self._count, 1)

    def cancel(self) -> None:
        """Take all that is left from the workers."""
        with self._changed:
            self._after.clear()
            self._changed.notify_all()


def make_plan(need: Need, src: Path = ROOT / 'src') -> Plan:
    """Plan the import of the modules with kernels; nothing is run for it.

    The weight is the size of the compiled source below a module. It only decides how evenly the workers are used.
    """
    sources = Sources(src)
    kernels = {name for name, path in sources.files.items() if has_kernel(path)}
    if need is Need.DEMO:
        kernels &= sources.closure(entry_points(src))
    size = {name: path.stat().st_size for name, path in sources.files.items() if is_compiled(path)}
    below = {name: sources.closure([name]) for name in kernels}
    weight = {name: float(sum(size.get(b, 0) for b in below[name])) for name in kernels}
    if need is Need.DEMO:
        below[SCENARIO] = set(kernels)
        weight[SCENARIO] = 0.0
    return Plan(below, weight)


def compiled_sources(src: Path = ROOT / 'src') -> list[Path]:
    """Name the files that machine code may depend on."""
    return [path for path in Sources(src).files.values() if is_compiled(path)]


def is_compiled(path: Path) -> bool:
    """Whether a module's source names a compiler."""
    return bool(COMPILED.search(path.read_text(encoding='utf-8')))


def has_kernel(path: Path) -> bool:
    """Whether a module makes kernels."""
    return bool(KERNEL.search(path.read_text(encoding='utf-8')))


def entry_points(src: Path) -> list[str]:
    """Name the modules of the nodes' executables, from every setup.py."""
    return [
        module
        for path in src.glob('*/setup.py')
        for module in ENTRY.findall(path.read_text(encoding='utf-8'))
    ]
