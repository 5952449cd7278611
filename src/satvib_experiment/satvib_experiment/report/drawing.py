# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of a report in processes of their own, one a core.

To import matplotlib takes as long as to draw four figures. So the processes start before there is anything to draw, and
import while the run is read and analysed. Where none can be started, or one ends before its time, this process draws.
"""

import importlib
import os
import pickle
import queue
import subprocess
import sys
import threading
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from satvib_common.process.parallel import cores

from satvib_experiment.report.context import Context
from satvib_experiment.report.figures.registry import FIGURES, Drawn, draw_figure, figure_module

MOST = 4  # figures are few


class Drawing:
    """Processes that draw; a context manager.

    Args:
        count: how many; None: one for each core that this process may use.

    Raises:
        OSError: from `draw`, when a figure cannot be written.
    """

    def __init__(self, count: int | None = None) -> None:
        self._processes: list[subprocess.Popen[bytes]] = []
        for _ in range(min(cores(), MOST) if count is None else count):
            try:
                self._processes.append(_start())
            except OSError:
                break

    def __enter__(self) -> Self:
        """Give itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, _: TracebackType | None
    ) -> None:
        """End the processes."""
        self.close()

    def close(self) -> None:
        """End the processes; what they have not drawn is not drawn."""
        for process in self._processes:
            process.kill()
            process.communicate()
        self._processes.clear()

    def draw(self, context: Context, folder: Path) -> list[Drawn]:
        """Draw into `folder` every figure that the run has something to show for."""
        left: queue.SimpleQueue[str] = queue.SimpleQueue()
        names = [name for name, _ in FIGURES]
        for name in names:
            left.put(name)
        drawn: dict[str, Drawn | None] = {}
        errors: list[OSError] = []
        task = pickle.dumps((context, folder))
        threads = [
            threading.Thread(target=_serve, args=(process, task, left, drawn, errors))
            for process in self._processes
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        if errors:
            raise errors[0]
        for name in names:
            if name not in drawn:
                drawn[name] = draw_figure(context, folder, name)
        return [found for name in names if (found := drawn[name]) is not None]


def _start() -> subprocess.Popen[bytes]:
    """Start a process that draws; it finds what this one finds."""
    env = os.environ | {'PYTHONPATH': os.pathsep.join(path for path in sys.path if path)}
    return subprocess.Popen(
        [sys.executable, '-m', __name__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=env
    )


def _serve(
    process: subprocess.Popen[bytes],
    task: bytes,
    left: 'queue.SimpleQueue[str]',
    drawn: dict[str, Drawn | None],
    errors: list[OSError],
) -> None:
    """Give a process its task, and figure after figure, until none is left or the process has ended."""
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(len(task).to_bytes(8, 'big') + task)
        while not errors:
            name = left.get_nowait()
            process.stdin.write(f'{name}\n'.encode())
            process.stdin.flush()
            answer: Any = pickle.load(process.stdout)  # noqa: S301 # from our own process
            if isinstance(answer, OSError):
                errors.append(answer)
            else:
                drawn[name] = answer
    except (queue.Empty, BrokenPipeError, EOFError):
        return


def main() -> None:
    """Draw what comes in on standard input."""
    answers = os.fdopen(os.dup(1), 'wb')
    os.dup2(2, 1)  # what a library prints is no answer
    # what takes long to import, while there is nothing to draw yet
    importlib.import_module('satvib_experiment.scenario.scenario')
    for name, _ in FIGURES:
        figure_module(name)

    source = sys.stdin.buffer
    head = source.read(8)
    if not head:
        return
    task = source.read(int.from_bytes(head, 'big'))
    context, folder = pickle.loads(task)  # noqa: S301 # from the process that started this one
    for line in source:
        answer: Drawn | OSError | None
        try:
            answer = draw_figure(context, folder, line.decode().strip())
        except OSError as error:
            answer = error
        pickle.dump(answer, answers)
        answers.flush()


if __name__ == '__main__':
    main()
