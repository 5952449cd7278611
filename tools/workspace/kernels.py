# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Compiles the numerical kernels once, before nine processes want them at the same time.

A kernel is compiled when its module is imported, and kept beside the source. Here as many processes as there are cores
import the modules. They need the sources only, so they work while colcon builds. The demo gets what its nodes use; the
rest is compiled when a command needs more.
"""

import contextlib
import os
import subprocess
import threading
from pathlib import Path

from workspace import environment
from workspace.base import (
    CACHE,
    INHERITED,
    PYTHON,
    ROOT,
    SetupError,
    digest,
    failed,
    is_current,
    say,
    without,
    write_whole,
)
from workspace.plan import Need, Plan, compiled_sources, make_plan

WORKER = """
import importlib, sys
for line in sys.stdin:
    task = line.strip()
    exec(task) if ' ' in task else importlib.import_module(task)
    print('done', flush=True)
"""


class Kernels:
    """The work of compiling, in the background.

    Args:
        need: of the command.

    Nothing is done when it was done before, from the same sources.
    """

    def __init__(self, need: Need) -> None:
        self._plan: Plan | None = None
        self._threads: list[threading.Thread] = []
        self._errors: list[SetupError] = []
        self._workers: list[subprocess.Popen[str]] = []
        self._stamps: list[Path] = []
        self._quarters = 0  # of the work, that have been told
        if need is Need.NOTHING:
            return
        self._wanted = digest(compiled_sources(), environment.STAMP.read_text(), str(ROOT))
        both = [CACHE / 'kernels-demo', CACHE / 'kernels-all']
        self._stamps = both if need is Need.ALL else both[:1]
        # all holds for the demo, too
        if not any(is_current(stamp, self._wanted) for stamp in (both[-1], self._stamps[-1])):
            self._plan = make_plan(need)

    def start(self) -> None:
        """Let the work begin."""
        if self._plan is not None:
            say('compiling the numerical kernels')
            for number in range(max(1, len(os.sched_getaffinity(0)))):
                arguments = (self._plan, f'compiling kernels {number + 1}')
                thread = threading.Thread(target=self._work, args=arguments, daemon=True)
                thread.start()
                self._threads.append(thread)

    def wait(self) -> None:
        """Wait for the end of the work.

        Raises:
            SetupError: a kernel does not compile.
        """
        for thread in self._threads:
            thread.join()
        if self._errors:
            raise self._errors[0]
        if self._plan is not None:
            for stamp in self._stamps:
                write_whole(stamp, self._wanted)

    def stop(self) -> None:
        """End what is still at work; it does not count."""
        if self._plan is not None:
            self._plan.cancel()
        for worker in self._workers:
            worker.kill()
            worker.wait()

    def _work(self, plan: Plan, name: str) -> None:
        path = CACHE / 'log' / f'{name}.log'
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open('w') as log:
                worker = start_worker(log.fileno())
        except OSError as error:
            self._errors.append(SetupError(f'{path}: {error.strerror}'))
            plan.cancel()
            return
        self._workers.append(worker)
        assert worker.stdin is not None
        assert worker.stdout is not None
        with contextlib.suppress(BrokenPipeError):
            while task := plan.take():
                worker.stdin.write(f'{task}\n')
                worker.stdin.flush()
                if not worker.stdout.readline():
                    break
                plan.done(task)
                self._tell(plan)
        with contextlib.suppress(BrokenPipeError):
            worker.stdin.close()
        if code := worker.wait():
            self._errors.append(failed(name, code, path))
            plan.cancel()

    def _tell(self, plan: Plan) -> None:
        quarters = int(4 * plan.share)
        if self._quarters < quarters < 4:
            self._quarters = quarters
            say(f'compiling the numerical kernels: {25 * quarters} % of the modules')


def start_worker(log: int) -> subprocess.Popen[str]:
    """Start a process that imports what it is sent, line by line, and answers each."""
    paths = [str(path.parent) for path in sorted((ROOT / 'src').glob('*/setup.py'))]
    # what is imported stays compiled, kernels and bytecode; and the wheels of ROS restart every Python that does not
    # say that its library path is set
    env = without(
        'PYTHONDONTWRITEBYTECODE',
        'PYTHONHOME',
        PYTHONPATH=os.pathsep.join(paths),
        _ROS_WHEELS_BOOTSTRAP_COMPLETE='1',
    )
    return subprocess.Popen(
        [str(PYTHON), '-c', WORKER],
        cwd=ROOT,
        env=env,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=log,
        text=True,
        pass_fds=INHERITED,
    )
