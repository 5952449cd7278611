# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Who runs the parts of a campaign: this process, processes of this machine, or any machines, by Dask distributed.

A part is a task: it gets its own piece of the plan, and gives back the Parquet file of its trials as bytes. A task
whose worker ends early is run again by another; its result does not depend on where it ran.
"""

from __future__ import annotations

import contextlib
import logging
import platform
import secrets
from collections.abc import Iterator
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.process.parallel import LIVES, cores, run_in_processes
from satvib_experiment.report.result import versions

from satvib_studies.campaign.batch import run_part
from satvib_studies.campaign.report.table import make_table, to_bytes
from satvib_studies.campaign.store import Store
from satvib_studies.campaign.trials import TrialPlan

_SMALLER = 'make the parts smaller with chunk'
_CONNECT = 10  # s
_WORKERS = 30  # s


def software() -> dict[str, str]:
    """Versions of everything that the bits of a trial may depend on."""
    found = versions()
    found.pop('matplotlib', None)
    return found | {'machine': platform.machine()}


def run_task(plan: TrialPlan, first: int, wanted: dict[str, str]) -> bytes:
    """Run one part on a worker and give its Parquet file.

    Raises:
        SatvibError: the worker has other software than the one who asks.
    """
    own = software()
    for name, version in wanted.items():
        if own.get(name) != version:
            raise SatvibError(
                f'worker on {platform.node()}: {name} {own.get(name)}, the campaign has {version}; '
                'all machines need the same'
            )
    return to_bytes(make_table(plan, first, run_part(plan)))


def run_parts(
    plan: TrialPlan, store: Store, scheduler: str | None, workers: int | None
) -> Iterator[tuple[int, bytes]]:
    """Run what is not finished, and give (number, Parquet file) of the parts as they are done.

    Args:
        plan: the whole campaign.
        store: knows what is finished.
        scheduler: address of a Dask scheduler; None: processes of this machine.
        workers: how many of these; None: one per core; 0: this process.

    Raises:
        SatvibError: no scheduler there, or a part that failed for good.
    """
    campaign = plan.campaign
    waiting = [i for i in range(campaign.chunks) if i not in store.finished]
    if not waiting:
        return
    if scheduler is None and workers == 0:
        for index in waiting:
            trials = campaign.chunk_of(index)
            yield index, run_task(plan.part(trials), trials.start, software())
        return
    if scheduler is None:
        wanted = software()

        def arguments(index: int) -> tuple[TrialPlan, int, dict[str, str]]:
            trials = campaign.chunk_of(index)
            return plan.part(trials), trials.start, wanted

        count = min(workers or cores(), len(waiting))
        yield from run_in_processes(run_task, arguments, waiting, count, advice=_SMALLER)
        return
    with _client(scheduler) as client:
        _wait_for_workers(client, scheduler)
        yield from _distributed(client, plan, waiting)


def unprotected(scheduler: str) -> str:
    """Give a line about a scheduler that anybody on the network can use, or an empty text.

    Args:
        scheduler: its address; one of this machine is not spoken of.
    """
    protocol, _, host = scheduler.rpartition('://')
    if protocol not in {'tcp', ''} or host.startswith(('127.', 'localhost', '[::1]')):
        return ''
    return (
        f'{scheduler}: this connection is neither encrypted nor authenticated; whoever reaches the scheduler can run '
        'code; make keys with: ./satvib campaign --make-keys FILE'
    )


@contextlib.contextmanager
def _client(scheduler: str) -> Iterator[Any]:
    """Give a client of a Dask scheduler."""
    import dask
    from distributed import Client

    _quiet()
    settings = {
        'distributed.scheduler.allowed-failures': LIVES,
        'distributed.comm.timeouts.connect': f'{_CONNECT}s',
        'distributed.admin.tick.limit': '1h',
        'logging': {'distributed': 'critical', 'distributed.worker': 'critical'},
    }
    with dask.config.set(settings):
        try:
            client = Client(scheduler, timeout=_CONNECT, set_as_default=False)
        except (OSError, ValueError, TypeError, TimeoutError) as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise SatvibError(
                f'--scheduler {scheduler}: cannot be reached ({reason}); start one with: '
                './satvib shell, then dask scheduler'
            ) from None
        with client:
            yield client


def _wait_for_workers(client: Any, scheduler: str) -> None:
    """Give workers the time to come.

    Raises:
        SatvibError: there is none.
    """
    try:
        client.wait_for_workers(1, timeout=_WORKERS)
    except TimeoutError:
        raise SatvibError(
            f'--scheduler {scheduler}: has no workers; start some with: ./satvib shell, then '
            f'dask worker {scheduler}'
        ) from None


def _distributed(client: Any, plan: TrialPlan, waiting: list[int]) -> Iterator[tuple[int, bytes]]:
    from concurrent.futures import CancelledError

    from distributed import KilledWorker, as_completed

    wanted, run = software(), secrets.token_hex(4)
    futures = {}
    for index in waiting:
        trials = plan.campaign.chunk_of(index)
        future = client.submit(
            run_task, plan.part(trials), trials.start, wanted, key=f'satvib-{run}-{index}',
            priority=-index,
        )  # fmt: skip
        futures[future.key] = (future, index)
    try:
        for future in as_completed([f for f, _ in futures.values()], loop=client.loop):
            index = futures.pop(future.key)[1]
            try:
                data = future.result()
            except KilledWorker:
                raise SatvibError(
                    f'part {index}: {LIVES} workers died while they ran it (too little memory?); '
                    f'{_SMALLER}'
                ) from None
            except (CancelledError, OSError) as error:
                raise SatvibError(
                    f'the scheduler at {client.scheduler.address} is lost ({type(error).__name__})'
                ) from None
            future.release()
            yield index, data
    finally:
        client.cancel([f for f, _ in futures.values()])


def _quiet() -> None:
    """Keep Dask's own messages off the terminal; the campaign reports what matters."""
    for name in ('distributed', 'distributed.nanny', 'distributed.scheduler', 'distributed.core',
                 'distributed.worker', 'distributed.client', 'tornado.application'):  # fmt: skip
        logging.getLogger(name).setLevel(logging.CRITICAL)
