# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Work in several processes of this machine: one that dies costs no work, and none outlives its parent.

They speak over pipes: no stranger can connect to them. The results do not depend on how many they are.
"""

import multiprocessing
import os
import signal
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Any, TypeVar

from satvib_common.errors import SatvibError

LIVES = 5
_PATIENCE = 1.0  # s, for the end of a process to be written down
Result = TypeVar('Result')


def cores() -> int:
    """Cores that this process may use."""
    # not every system can say which
    return len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else os.cpu_count() or 1


def run_in_processes(
    task: Callable[..., Result],
    arguments: Callable[[int], tuple[Any, ...]],
    parts: Iterable[int],
    workers: int,
    lives: int = LIVES,
    called: Callable[[int], str] = 'part {}'.format,
    advice: str = '',
) -> Iterator[tuple[int, Result]]:
    """Run parts in processes of this machine and give (number, result) as they are done.

    A process that dies takes the others with it: they are begun again, and so are the parts that were in them. A part
    that has one life left runs alone, so that no other part can be the reason.

    Args:
        task: a function of a module; it gives the same result each time it is called with the same arguments.
        arguments: of the task, by the number of the part; asked for when the part begins.
        parts: numbers.
        workers: processes, at most; at least 1.
        lives: deaths of processes after which a part that was in one of them each time is given up.
        called: what an error calls a part, by its number.
        advice: what an error about a part that was given up tells people to do.

    Raises:
        SatvibError: a part was given up.
        Exception: what the task raised; nothing more is run.
    """
    waiting, deaths = list(parts), Counter[int]()
    while waiting:
        running: dict[Future[Result], int] = {}
        with _pool(min(workers, len(waiting))) as pool:
            try:
                while waiting or running:
                    # no more than there are processes: what is in the air when one dies is what it may have died of
                    while waiting and len(running) < workers:
                        beside = (waiting[0], *running.values())
                        if running and any(deaths[part] >= max(lives - 1, 1) for part in beside):
                            break
                        with _deaf():
                            running[pool.submit(task, *arguments(waiting[0]))] = waiting[0]
                        del waiting[0]
                    for future in wait(running, return_when=FIRST_COMPLETED).done:
                        data = future.result()
                        yield running.pop(future), data
            except BrokenProcessPool:
                deaths.update(running.values())
                waiting = sorted([*running.values(), *waiting])
                worst = max(waiting, key=lambda part: deaths[part])
                if deaths[worst] >= lives:
                    raise SatvibError(
                        f'{called(worst)}: {lives} times a process died while it ran it (too little memory?)'
                        + (f'; {advice}' if advice else '')
                    ) from None


@contextmanager
def _pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that end with the block, whatever they do, and with this process, however it ends."""
    # each from its beginning: this process may have threads, which a fork would leave in the middle of what they do
    context = multiprocessing.get_context('spawn')
    others = {process.pid for process in multiprocessing.active_children()}
    pool = ProcessPoolExecutor(workers, context, initializer=_end_with_parent)
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            if process.pid not in others:
                process.kill()
                process.join()
                # where the pool's own thread has heard of its end first, it is still to write that down
                patient_until = time.monotonic() + _PATIENCE
                while process.is_alive() and time.monotonic() < patient_until:
                    time.sleep(0.001)


def _end_with_parent() -> None:
    """End this process when the one that made it has died."""
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def _deaf() -> Iterator[None]:
    """Let processes that begin here not hear Control-C: the one who started them hears it, and ends them in order."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
