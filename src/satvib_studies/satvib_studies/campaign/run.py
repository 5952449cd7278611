# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A campaign from beginning to end: plan, run what is missing, keep every part, join, report.

    folder = begin(campaign, Path('runs/payload-001'))
    table = go_on(folder, workers=2)

Interrupt it anywhere, by any means: `go_on` again runs what no finished part has.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
from satvib_common.errors import SatvibError

from satvib_studies.campaign.settings import Campaign
from satvib_studies.campaign.store import Store
from satvib_studies.campaign.trials import TrialPlan, plan_from, plan_trials
from satvib_studies.campaign.workers import run_parts, software

# called after every part: trials done, trials of the campaign
Progress = Callable[[int, int], None]


def _silent(done: int, total: int) -> None:
    """Report nothing."""


def begin(campaign: Campaign, folder: Path) -> Store:
    """Check a campaign and file it in a folder, which is made; nothing is run.

    Raises:
        SatvibError: anything wrong with the campaign, or a folder that is there already.
    """
    from satvib_experiment.recording.run_folder import make_run_folder

    plan = plan_trials(campaign)
    make_run_folder(folder)
    return Store.create(folder, campaign, plan.base, software())


def resume(folder: Path, redo: int | None = None) -> Store:
    """Open the folder of a campaign that was interrupted.

    Args:
        folder: of the campaign.
        redo: number of a part to be run again, when it is damaged.

    Raises:
        SatvibError: no campaign there, a damaged part, other software than it began with.
    """
    store = Store(folder)
    if redo is not None:
        store.forget(redo)
    store.check()
    own = software()
    for name, version in store.software.items():
        if own.get(name) != version:
            raise SatvibError(
                f'{folder}: began with {name} {version}, here is {own.get(name)}; trials would not '
                'be of one kind, start a new campaign'
            )
    return store


def go_on(
    store: Store,
    scheduler: str | None = None,
    workers: int | None = None,
    progress: Progress = _silent,
) -> tuple[TrialPlan, pa.Table]:
    """Run what is missing, and give the plan and the table of all trials.

    Args:
        store: of `begin` or `resume`.
        scheduler: address of a Dask scheduler; None: this machine alone.
        workers: processes of this machine; None: one per core; 0: this one.
        progress: called after every part.

    Raises:
        SatvibError: no scheduler, no room on the disk; what is finished is kept.
    """
    plan = plan_from(store.campaign, store.scenario)
    total = store.campaign.trials
    progress(store.trials_done if store.result is None else total, total)
    if store.result is None:
        try:
            for index, data in run_parts(plan, store, scheduler, workers):
                store.keep(index, data)
                progress(store.trials_done, total)
        except SatvibError as error:
            raise SatvibError(f'{error}; {store.kept()}') from None
    return plan, store.finish()
